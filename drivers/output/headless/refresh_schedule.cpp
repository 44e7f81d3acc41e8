// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/headless/refresh_schedule.h"

#include <cmath>

#include "common/base/check.h"

namespace cyclorama::output {

RefreshSchedule::RefreshSchedule(double refresh_hz, TimePoint start) : period_s_(1.0 / refresh_hz), start_(start) {
  CHECK(refresh_hz > 0.0);
}

TimePoint RefreshSchedule::time_of(std::uint64_t number) const {
  return start_ +
         std::chrono::duration_cast<Duration>(std::chrono::duration<double>(period_s_ * static_cast<double>(number)));
}

RefreshSchedule::Refresh RefreshSchedule::next(TimePoint now) {
  std::uint64_t number = next_number_;
  if (now >= time_of(number + 1)) {
    number = static_cast<std::uint64_t>(std::ceil(to_seconds(now - start_) / period_s_));
    missed_ += number - next_number_;
  }
  next_number_ = number + 1;
  return {number, time_of(number)};
}

}  // namespace cyclorama::output
