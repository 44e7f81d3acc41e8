// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "drivers/camera/raw_picture.h"

namespace cyclorama::camera {

/// Requested picture of a real camera. The defaults suit tracking.
struct PicturePreference {
  int width_px = 640;
  int height_px = 480;
  double frames_per_second = 30.0;
  bool is_coloured = false;  ///< Requests colour in addition, if any offer has it.
};

/// One picture format, size and rate that a camera offers.
struct PictureOffer {
  std::uint32_t fourcc = 0;  ///< The device's code for the pixel format.
  PixelLayout layout = PixelLayout::kGrey8;
  int width_px = 0;
  int height_px = 0;
  double frames_per_second = 0.0;  ///< 0 if the device does not report it.
  bool is_coloured = false;        ///< True if its colours can be read.
};

/// Returns the index of the best offer. Criteria in decreasing order of weight: colour, if requested; a rate not below
/// the requested one; a size close to the requested one, larger rather than smaller; pixels that are cheap to read.
/// Hence 640x480 as YUYV is preferred to the same size as JPEG, unless only JPEG reaches the requested rate, as on a
/// USB 2 bus. Pure; independent of the order of equal offers.
///
/// Errors: kNotFound if there are no offers.
Result<std::size_t> choose_picture(const std::vector<PictureOffer>& offers, const PicturePreference& preferred);

/// Returns text such as "640x480 YUYV at 30 per second".
[[nodiscard]] std::string describe(const PictureOffer& offer);
/// Returns the four characters; '?' replaces unprintable ones.
[[nodiscard]] std::string fourcc_text(std::uint32_t fourcc);

}  // namespace cyclorama::camera
