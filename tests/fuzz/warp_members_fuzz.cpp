// SPDX-License-Identifier: Apache-2.0
// Pictures inside a warp: a map as PFM, a mask as PNG.
#include <cstddef>
#include <cstdint>
#include <span>

#include "appliance/interchange/mask_png.h"
#include "appliance/interchange/warp_pfm.h"
#include "common/base/check.h"
#include "common/image/pfm.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const auto bytes = std::as_bytes(std::span(data, size));
  const interchange::WarpLimits limits{.map_px = 1 << 16};
  if (const auto map = interchange::decode_warp_pfm(bytes, limits)) {
    const auto back = interchange::decode_warp_pfm(encode_pfm(*map), limits);
    CHECK(back.has_value() && interchange::same_bits(*back, *map));
  }
  if (const auto mask = interchange::decode_mask_png(bytes, limits.map_px)) {
    const auto png = interchange::encode_mask_png(*mask);
    CHECK(png.has_value());
    const auto back = interchange::decode_mask_png(*png, limits.map_px);
    CHECK(back.has_value() && *back == *mask);
  }
  return 0;
}
