// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/pace.h"

#include <algorithm>

namespace cyclorama::camera {

std::uint64_t Pace::next(TimePoint now, std::optional<std::uint64_t> last) const {
  const auto elapsed = std::max<Duration::rep>((now - first_at) / period, 0);
  const auto newest = now < first_at ? std::uint64_t{0} : static_cast<std::uint64_t>(elapsed);
  return last ? std::max(newest, *last + 1) : newest;
}

Result<std::uint64_t> wait_for_picture(const Pace& pace, std::optional<std::uint64_t> last, const Clock& clock,
                                       TimePoint deadline) {
  const TimePoint now = clock.now();
  const std::uint64_t sequence = pace.next(now, last);
  const TimePoint ready_at = pace.ready_at(sequence);
  if (ready_at > now && ready_at > deadline) {
    clock.wait_until(deadline);
    return Error(ErrorCode::kTimedOut, "no picture before the deadline");
  }
  clock.wait_until(ready_at);
  return sequence;
}

Duration period_of(double frames_per_second) {
  CHECK(frames_per_second >= 0.01 && frames_per_second <= 1000.0);
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1.0 / frames_per_second));
}

}  // namespace cyclorama::camera
