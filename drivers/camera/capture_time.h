// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/clock.h"

namespace cyclorama::camera {

/// What a driver says of when a picture was taken.
struct KernelStamp {
  bool is_monotonic = false;          ///< On CLOCK_MONOTONIC; else it says nothing.
  bool is_start_of_exposure = false;  ///< Else it is the end of the picture's transfer.
  TimePoint at{};
};

/// Start of exposure, as well as it can be known at `now`, when the picture was taken from the driver. Never later than
/// `now`, nor more than kMaxStampAge before it: a stamp outside of that is of another clock, or of a device that counts
/// wrong, and `now` stands in for it. From an end-of-transfer stamp, the exposure (zero: not known) is subtracted; the
/// time of reading out the sensor, at most one picture's, no driver tells.
[[nodiscard]] TimePoint capture_time(const KernelStamp& stamp, Duration exposure, TimePoint now);

/// No picture waits for this long in a driver's few buffers while it is read for.
inline constexpr Duration kMaxStampAge = std::chrono::seconds(10);

}  // namespace cyclorama::camera
