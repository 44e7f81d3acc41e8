// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/check.h"
#include "common/image/radiance_hdr.h"

// The first byte selects whether the rest is a whole file or the rows of a small picture.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kLimitPx = std::size_t{1} << 20;
  if (size == 0) return 0;
  std::string file = data[0] % 2 == 0 ? "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 3 +X 40\n" : "";
  file += std::string_view(reinterpret_cast<const char*>(data), size).substr(1);
  const auto image = cyclorama::decode_radiance_hdr(std::as_bytes(std::span(file.data(), file.size())), kLimitPx);
  if (!image) return 0;
  CHECK(!image->empty() && image->data().size() <= 3 * kLimitPx);
  for (const float v : image->data()) CHECK(v >= 0.0f && v <= 1e9f);
  return 0;
}
