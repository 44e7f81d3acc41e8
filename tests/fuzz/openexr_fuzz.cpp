// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>

#include "common/base/check.h"
#include "common/image/openexr.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kLimitPx = std::size_t{1} << 20;
  const auto image = cyclorama::decode_openexr(std::as_bytes(std::span(data, size)), kLimitPx);
  if (!image) return 0;
  CHECK(!image->empty() && image->data().size() <= 3 * kLimitPx);
  for (const float v : image->data()) CHECK(v >= 0.0f && v <= 1e9f);
  return 0;
}
