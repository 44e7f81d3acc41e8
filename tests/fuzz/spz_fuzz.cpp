// SPDX-License-Identifier: Apache-2.0
#include "common/base/check.h"
#include "renderfarm/scene/spz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::size_t left_out = 0;
  const auto cloud =
      cyclorama::scene::decode_spz(std::as_bytes(std::span(data, size)), std::size_t{64} << 20, &left_out);
  if (!cloud) return 0;
  CHECK(cloud->coefficients.size() == cloud->size() * cloud->coefficient_count());
  for (const float opacity : cloud->opacities) CHECK(opacity > 0.0f && opacity <= 1.0f);
  return 0;
}
