// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "common/base/result.h"
#include "common/image/image.h"
#include "common/image/jpeg.h"

namespace cyclorama {

/// How a camera's bytes hold brightness, which is all that tracking looks at. In the order of what it costs to read.
enum class PixelLayout {
  kGrey8,      ///< GREY.
  kPlanarYuv,  ///< A first plane as kGrey8, then colour: NV12, NV21, NV16, YU12, YV12, 422P...
  kGrey16,     ///< Two bytes per pixel, the low one first, all 16 bits used: Y16.
  kGrey12,     ///< As kGrey16, 12 bits used.
  kGrey10,     ///< As kGrey16, 10 bits used.
  kYuyv,       ///< Brightness in every even byte: YUYV, YVYU.
  kUyvy,       ///< Brightness in every odd byte: UYVY, VYUY.
  kJpeg,       ///< A JPEG per picture: MJPG, JPEG.
};

[[nodiscard]] std::string_view name_of(PixelLayout layout);
/// Of one pixel in its row; 0 for a JPEG.
[[nodiscard]] std::size_t bytes_per_pixel(PixelLayout layout);

/// One picture as the device left it. A view: it owns nothing.
struct RawPicture {
  PixelLayout layout = PixelLayout::kGrey8;
  int width = 0;
  int height = 0;
  std::size_t row_bytes = 0;  ///< From one row to the next; of no meaning for a JPEG.
  std::span<const std::byte> bytes;
};

/// Brightness as the device means it: a YUV device's black may be 16 and its white 235, which no tag detector minds.
///
/// kBadData  fewer bytes than the picture needs, a damaged JPEG, or one of another size. `ret_grey` is then
/// unspecified.
Status to_grey(const RawPicture& raw, JpegDecoder* jpeg, GreyImage* ret_grey);

}  // namespace cyclorama
