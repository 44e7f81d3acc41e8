// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/clock.h"

namespace cyclorama::camera {

/// Time stamp that a driver gives to a picture.
struct KernelStamp {
  bool is_monotonic = false;          ///< True if the stamp is on CLOCK_MONOTONIC; others are ignored.
  bool is_start_of_exposure = false;  ///< True for the start of exposure, false for the end of the transfer.
  TimePoint at{};
};

/// Returns the best estimate of the start of exposure for a picture that was taken from the driver at `now`. The result
/// is not later than `now` and at most kMaxStampAge earlier: a stamp outside that interval comes from another clock or
/// a faulty device, and `now` is used instead. The exposure (zero if unknown) is subtracted from a stamp of the
/// transfer's end. The readout time of the sensor, at most one picture period, is ignored, since no driver reports it.
[[nodiscard]] TimePoint capture_time(const KernelStamp& stamp, Duration exposure, TimePoint now);

/// Upper bound on the time for which a picture waits in a driver's buffers, if a reader takes pictures steadily.
inline constexpr Duration kMaxStampAge = std::chrono::seconds(10);

}  // namespace cyclorama::camera
