// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "drivers/camera/raw_picture.h"

namespace cyclorama::camera {

/// What whoever wants pictures asks of a real camera. The defaults are what tracking needs.
struct PicturePreference {
  int width_px = 640;
  int height_px = 480;
  double frames_per_second = 30.0;
  bool is_coloured = false;  ///< Colours as well, where any of the offers has them.
};

/// One thing that a camera can be told to send.
struct PictureOffer {
  std::uint32_t fourcc = 0;  ///< The device's own name of the pixels.
  PixelLayout layout = PixelLayout::kGrey8;
  int width_px = 0;
  int height_px = 0;
  double frames_per_second = 0.0;  ///< 0: the device does not say.
  bool is_coloured = false;        ///< Its colours can be read.
};

/// The offer to take. In this order of weight: colours, where they are wanted; the rate is reached; the size is near,
/// larger rather than smaller; the pixels are cheap to read. So 640x480 as YUYV beats it as JPEG, unless only the JPEG
/// comes at the rate that is wanted, as on a USB 2 bus. Pure; the same for any order of equal offers.
///
/// kNotFound  there is none.
Result<std::size_t> choose_picture(const std::vector<PictureOffer>& offers, const PicturePreference& preferred);

/// "640x480 YUYV at 30 per second".
[[nodiscard]] std::string describe(const PictureOffer& offer);
/// The four letters; '?' where one is no letter.
[[nodiscard]] std::string fourcc_text(std::uint32_t fourcc);

}  // namespace cyclorama::camera
