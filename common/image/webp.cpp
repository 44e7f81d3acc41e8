// SPDX-License-Identifier: Apache-2.0
#include "common/image/webp.h"

#include <fmt/format.h>
#include <webp/decode.h>

#include <cstdint>

namespace cyclorama {

Result<RgbaImage> decode_webp(std::span<const std::byte> webp, std::size_t limit_px) {
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(webp.data());
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(bytes, webp.size(), &features) != VP8_STATUS_OK || features.width < 1 || features.height < 1) {
    return Error(ErrorCode::kBadData, "the WebP header is damaged; copy or export the picture again");
  }
  if (features.has_animation != 0) {
    return Error(ErrorCode::kBadData, "this is an animated WebP; export one picture of it");
  }
  if (static_cast<std::size_t>(features.width) * static_cast<std::size_t>(features.height) > limit_px) {
    return Error(ErrorCode::kBadData, fmt::format("the WebP has {}x{} pixels; at most {} pixels are accepted here",
                                                  features.width, features.height, limit_px));
  }
  RgbaImage image(features.width, features.height);
  if (WebPDecodeRGBAInto(bytes, webp.size(), image.data().data(), image.data().size(),
                         static_cast<int>(image.row_values())) == nullptr) {
    return Error(ErrorCode::kBadData, "the WebP is damaged or cut short; copy or export the picture again");
  }
  return image;
}

}  // namespace cyclorama
