// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/clock.h"

namespace cyclorama::camera {

/// Time stamp that a driver gives to a picture.
struct KernelStamp {
  bool is_monotonic = false;          ///< On CLOCK_MONOTONIC; otherwise the stamp is not used.
  bool is_start_of_exposure = false;  ///< Otherwise it is the end of the picture's transfer.
  TimePoint at{};
};

/// Returns the best estimate of the start of exposure for a picture that was taken from the driver at `now`. The result
/// is never later than `now`, nor more than kMaxStampAge before it: a stamp outside that interval belongs to another
/// clock or to a faulty device, and `now` replaces it. The exposure (zero if unknown) is subtracted from an
/// end-of-transfer stamp; the readout time of the sensor, at most one picture period, is reported by no driver and is
/// ignored.
[[nodiscard]] TimePoint capture_time(const KernelStamp& stamp, Duration exposure, TimePoint now);

/// Upper bound on the time that a picture waits in a driver's few buffers while a reader takes pictures.
inline constexpr Duration kMaxStampAge = std::chrono::seconds(10);

}  // namespace cyclorama::camera
