// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/v4l2/exposure.h"

#include <linux/videodev2.h>

#include <algorithm>

#include "drivers/camera/v4l2/stepped_range.h"

namespace cyclorama::camera {
const std::uint32_t kGainControl = V4L2_CID_GAIN;

Result<ExposureSet> set_exposure(const VideoDevice& device, Duration requested, GainRule gain) {
  ExposureSet set;
  if (requested <= Duration::zero()) return set;
  // The order matters: UVC devices accept an exposure time only once exposure is manual.
  TRY_ASSIGN(const bool is_manual, device.set_control(V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL));
  if (!is_manual) {
    // Some devices support only shutter priority: manual exposure time, automatic aperture.
    TRY(device.set_control(V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_SHUTTER_PRIORITY));
  }
  TRY(device.set_control(V4L2_CID_EXPOSURE_AUTO_PRIORITY, 0));
  if (const auto time = device.control(V4L2_CID_EXPOSURE_ABSOLUTE)) {
    const long value = nearest_step(time->min, time->max, time->step, std::max(1L, requested / kExposureUnit));
    TRY_ASSIGN(const bool is_taken, device.set_control(V4L2_CID_EXPOSURE_ABSOLUTE, value));
    // The value is read back, since some devices accept an impossible value and apply the nearest possible one.
    const auto now = is_taken ? device.control(V4L2_CID_EXPOSURE_ABSOLUTE) : std::nullopt;
    if (is_taken) set.exposure = kExposureUnit * (now ? now->value : value);
  }
  if (gain == GainRule::kHeld) {
    // Devices without these controls refuse them.
    TRY(device.set_control(V4L2_CID_AUTOGAIN, 0));
    TRY(device.set_control(V4L2_CID_AUTO_WHITE_BALANCE, 0));
    TRY(device.set_control(V4L2_CID_FOCUS_AUTO, 0));  // A change of focus changes the intrinsics.
    return set;
  }
  TRY_ASSIGN(const bool follows_light, device.set_control(V4L2_CID_AUTOGAIN, 1));
  if (!follows_light && set.exposure) {
    if (const auto range = device.control(V4L2_CID_GAIN); range && range->max > range->min) {
      set.gain = GainRange{range->min, range->max, range->step};
      set.gain_now = range->value;
    }
  }
  return set;
}

}  // namespace cyclorama::camera
