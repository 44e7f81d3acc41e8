// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/refresh_pace.h"

#include <algorithm>
#include <cmath>

#include "common/base/check.h"

namespace cyclorama::output {
namespace {

// KWin uses a margin of 1.5 ms (src/backends/drm/drm_commit_thread.cpp); a sleeping thread wakes up to 1 ms late.
constexpr auto kMinExtra = std::chrono::microseconds(2500);
// Each refresh that is met multiplies the extra time by this factor: half of it remains after 140 refreshes.
constexpr double kEasing = 0.995;

Duration period_of(double refresh_hz) {
  CHECK(refresh_hz > 0.0);
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1.0 / refresh_hz));
}

}  // namespace

RefreshPace::RefreshPace(double refresh_hz, TimePoint now)
    : period_(period_of(refresh_hz)), extra_(kMinExtra), shown_at_(now) {}

void RefreshPace::set_rate(double refresh_hz) { period_ = period_of(refresh_hz); }

TimePoint RefreshPace::begin_at() const {
  if (!has_raster_) return next_at();
  const Duration slowest = *std::max_element(took_.begin(), took_.end());
  return next_at() - std::min(period_, slowest + extra_);
}

void RefreshPace::drawn(Duration took) {
  took_[next_took_] = took;
  next_took_ = (next_took_ + 1) % took_.size();
}

void RefreshPace::shown(TimePoint at, bool has_raster) {
  const double passed = to_seconds(at - shown_at_) / to_seconds(period_);
  const std::uint64_t count =
      std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(std::max(0.0, passed))));
  if (count > 1) {
    extra_ = std::min(2 * extra_, period_);
  } else {
    extra_ = std::max<Duration>(kMinExtra, std::chrono::duration_cast<Duration>(kEasing * extra_));
  }
  number_ += count;
  shown_at_ = std::max(at, shown_at_ + Duration(1));
  has_raster_ = has_raster;
}

}  // namespace cyclorama::output
