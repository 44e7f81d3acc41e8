// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "common/base/result.h"
#include "common/image/image.h"
#include "common/image/jpeg.h"

namespace cyclorama::camera {

/// Layout of the brightness in a camera's picture. Tracking uses only the brightness.
enum class PixelLayout {
  kGrey8,      ///< GREY.
  kPlanarYuv,  ///< First plane like kGrey8, then colour: NV12, NV21, NV16, YU12, YV12, 422P...
  kGrey16,     ///< Two bytes per pixel, the low one first, all 16 bits used: Y16.
  kGrey12,     ///< Layout of kGrey16 with 12 bits used.
  kGrey10,     ///< Layout of kGrey16 with 10 bits used.
  kYuyv,       ///< Brightness in every even byte: YUYV, YVYU.
  kUyvy,       ///< Brightness in every odd byte: UYVY, VYUY.
  kJpeg,       ///< A JPEG per picture: MJPG, JPEG.
};

[[nodiscard]] std::string_view name_of(PixelLayout layout);
/// Returns the bytes per pixel in a row; 0 for a JPEG.
[[nodiscard]] std::size_t bytes_per_pixel(PixelLayout layout);

/// Layout of a picture's colours, which only a calibration uses.
enum class Chroma {
  kNone,     ///< No colour, or a layout that is not supported.
  kBetween,  ///< Interleaved with brightness, shared by every two pixels: kYuyv, kUyvy.
  kPairs,    ///< Pairs in a second plane, one per 2x2 pixels, with the row length of the first plane: NV12.
  kInJpeg,
};

/// Interpretation of a picture's colours.
struct ColourCode {
  Chroma chroma = Chroma::kNone;
  bool is_v_first = false;     ///< The red difference (Cr) comes before the blue one (Cb): YVYU, VYUY, NV21.
  bool is_full_range = false;  ///< Brightness from 0 to 255, not from 16 to 235; unused for a JPEG.
};

/// One picture as delivered by the device. A view: it owns nothing.
struct RawPicture {
  PixelLayout layout = PixelLayout::kGrey8;
  int width = 0;
  int height = 0;
  std::size_t row_bytes = 0;  ///< Distance between the starts of two rows in bytes; unused for a JPEG.
  std::span<const std::byte> bytes;
  ColourCode colour{};
};

/// Converts to grey, keeping the device's range: black may be 16 and white 235 for a YUV device, which does not affect
/// tag detection.
///
/// Errors: kBadData if there are fewer bytes than the picture needs, or a JPEG is damaged or of another size;
/// `ret_grey` is then unspecified.
Status to_grey(const RawPicture& raw, JpegDecoder* jpeg, GreyImage* ret_grey);

/// Converts to red, green and blue by ITU-R BT.601, clipped to 0 to 255. Precondition: `raw.colour.chroma` is not
/// kNone. Errors: those of to_grey().
Status to_colour(const RawPicture& raw, JpegDecoder* jpeg, RgbImage* ret_colour);

}  // namespace cyclorama::camera
