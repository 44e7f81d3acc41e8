// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/base/clock.h"
#include "drivers/camera/brightness.h"
#include "drivers/camera/v4l2/video_device.h"

namespace cyclorama::camera {

/// What set_exposure() could reach. A device without controls has neither, and works.
struct ExposureSet {
  std::optional<Duration> exposure;  ///< Fixed by us; nothing: the device's own, and it may change.
  std::optional<GainRange> gain;     ///< Ours to follow the light with; nothing: the device's, or there is none.
  long gain_now = 0;
};

/// A tracker's pictures stay bright enough; a calibration compares brightness between pictures.
enum class GainRule {
  kFollowsLight,
  kHeld,  ///< Automatic gain, white balance and focus are switched off, and stay as they are.
};

/// The control that GainRange is of.
extern const std::uint32_t kGainControl;

/// In which V4L2 counts exposure.
inline constexpr Duration kExposureUnit = std::chrono::microseconds(100);

/// Makes exposure short and steady: manual where the device can, `requested` or what is nearest to it; the rate no longer
/// falls in the dark; gain automatic where the device can do that with manual exposure, else given to the caller. A
/// zero `requested` leaves the device to itself. What the device refuses is left as it is.
///
/// kUnavailable  it is gone.
Result<ExposureSet> set_exposure(const VideoDevice& device, Duration requested,
                                 GainRule gain = GainRule::kFollowsLight);

}  // namespace cyclorama::camera
