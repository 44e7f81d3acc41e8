// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/attract_fade.h"

#include <algorithm>

namespace cyclorama::display {
namespace {
// Maximum time that one step advances the fade, so that a display that was stopped resumes the fade where it was.
constexpr Duration kMaxStep = std::chrono::milliseconds(50);
constexpr Duration kMinFade = std::chrono::milliseconds(1);
}  // namespace

void AttractFade::step(TimePoint now, bool is_new_frame, bool is_wrong) {
  const Duration passed = last_step_ == TimePoint{} ? Duration{} : std::clamp(now - last_step_, Duration{}, kMaxStep);
  last_step_ = now;
  if (is_new_frame || !is_wrong) right_at_ = now;
  if (is_new_frame) is_attracting_ = false;
  if (now - right_at_ > times_.after) is_attracting_ = true;
  const double step = to_seconds(passed) / to_seconds(std::max(times_.fade, kMinFade));
  progress_ = std::clamp(progress_ + (is_attracting_ ? step : -step), 0.0, 1.0);
}

double AttractFade::share() const { return progress_ * progress_ * (3.0 - 2.0 * progress_); }

}  // namespace cyclorama::display
