// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "common/base/result.h"
#include "common/image/image.h"
#include "common/image/jpeg.h"

namespace cyclorama::camera {

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

/// Where the colours of a picture are, which only a calibration looks at.
enum class Chroma {
  kNone,     ///< It has none, or keeps them in a way that is not read.
  kBetween,  ///< Between brightness, of every two pixels: kYuyv, kUyvy.
  kPairs,    ///< Pairs in a second plane, of every 2x2 pixels, in rows as long as the first one's: NV12.
  kInJpeg,
};

/// How a picture's colours are to be understood.
struct ColourCode {
  Chroma chroma = Chroma::kNone;
  bool is_v_first = false;     ///< Red's difference before blue's: YVYU, VYUY, NV21.
  bool is_full_range = false;  ///< Brightness from 0 to 255, not from 16 to 235. Of no meaning for a JPEG.
};

/// One picture as the device left it. A view: it owns nothing.
struct RawPicture {
  PixelLayout layout = PixelLayout::kGrey8;
  int width = 0;
  int height = 0;
  std::size_t row_bytes = 0;  ///< From one row to the next; of no meaning for a JPEG.
  std::span<const std::byte> bytes;
  ColourCode colour{};
};

/// Brightness as the device means it: a YUV device's black may be 16 and its white 235, which no tag detector minds.
///
/// kBadData  fewer bytes than the picture needs, a damaged JPEG, or one of another size. `ret_grey` is then
/// unspecified.
Status to_grey(const RawPicture& raw, JpegDecoder* jpeg, GreyImage* ret_grey);

/// Red, green and blue by ITU-R BT.601, what lies outside of 0 to 255 cut off. Precondition: `raw.colour.chroma` is not
/// kNone. Errors as to_grey().
Status to_colour(const RawPicture& raw, JpegDecoder* jpeg, RgbImage* ret_colour);

}  // namespace cyclorama::camera
