// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/base/clock.h"
#include "drivers/camera/brightness.h"
#include "drivers/camera/v4l2/video_device.h"

namespace cyclorama::camera {

/// Result of set_exposure(). A device without exposure and gain controls has neither value and can still be used.
struct ExposureSet {
  std::optional<Duration> exposure;  ///< Fixed exposure; nothing if the device may change it.
  /// Gain that the caller adjusts to the light; nothing if the device controls it or has none.
  std::optional<GainRange> gain;
  long gain_now = 0;
};

/// Gain policy: a tracker needs pictures that stay bright enough; a calibration compares brightness between pictures.
enum class GainRule {
  kFollowsLight,
  kHeld,  ///< Automatic gain, white balance and focus are switched off and keep their current values.
};

/// Id of the V4L2 control to which GainRange refers.
extern const std::uint32_t kGainControl;

/// Unit of V4L2's absolute exposure control.
inline constexpr Duration kExposureUnit = std::chrono::microseconds(100);

/// Makes the exposure short and steady. It is manual, at `requested` or the nearest possible value, if the device
/// supports that, and the frame rate no longer drops in the dark. Gain is automatic if the device supports automatic
/// gain with manual exposure; otherwise the caller controls it. A zero `requested` leaves everything automatic.
/// Settings that the device refuses keep their values.
///
/// Errors: kUnavailable if the device is gone.
Result<ExposureSet> set_exposure(const VideoDevice& device, Duration requested,
                                 GainRule gain = GainRule::kFollowsLight);

}  // namespace cyclorama::camera
