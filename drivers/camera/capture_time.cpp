// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/capture_time.h"

#include <algorithm>

namespace cyclorama::camera {

TimePoint capture_time(const KernelStamp& stamp, Duration exposure, TimePoint now) {
  if (!stamp.is_monotonic || stamp.at > now || stamp.at < now - kMaxStampAge) return now;
  if (stamp.is_start_of_exposure) return stamp.at;
  return stamp.at - std::clamp<Duration>(exposure, Duration::zero(), std::chrono::seconds(1));
}

}  // namespace cyclorama::camera
