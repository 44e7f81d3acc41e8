// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/view_pacer.h"

#include <google/protobuf/util/message_differencer.h>

#include <algorithm>

namespace cyclorama::tour {

void ViewPacer::set_refresh_period(Duration period) {
  if (period == period_) return;
  period_ = period;
  periods_ = kFirstPeriods;
  slower_ = kFirstSlower;
}

Duration ViewPacer::interval() const {
  return std::chrono::duration_cast<Duration>(periods_ * std::chrono::duration<double>(period_));
}

std::optional<TimePoint> ViewPacer::due_at() const {
  if (!frames_.has_room() || !asked_at_) return std::nullopt;
  return *asked_at_ + interval();
}

bool ViewPacer::is_due(TimePoint now) const {
  return frames_.has_room() && (!newest_ || !asked_at_ || now >= *asked_at_ + interval());
}

bool ViewPacer::wants(const wire::View& view, TimePoint now) const {
  if (!is_due(now)) return false;
  if (!newest_ || (!farm_refines_ && now - *asked_at_ >= kAtRest)) return true;
  wire::View same = *newest_;
  same.set_number(view.number());
  same.set_shutter_ns(view.shutter_ns());  // A newer camera picture of a still tag shows nothing new.
  return !google::protobuf::util::MessageDifferencer::Equals(same, view);
}

void ViewPacer::asked(const wire::View& view, TimePoint now) {
  frames_.add(view.number(), {});
  newest_ = view;
  asked_at_ = now;
}

std::size_t ViewPacer::began(std::uint64_t number) { return frames_.skip_before(number); }

void ViewPacer::ended(std::uint64_t number) { frames_.finish(number); }

void ViewPacer::shown() { periods_ = std::max(1.0, periods_ * (1.0 - kFaster)); }

void ViewPacer::not_shown(Duration next_after) {
  if (period_ == Duration::zero()) return;
  const double too_short = to_seconds(next_after) / to_seconds(period_);
  const double max = std::max(1.0, to_seconds(kMaxInterval) / to_seconds(period_));
  periods_ = std::min(max, periods_ * std::clamp(too_short / periods_, 1.0 + slower_, 1.0 + kMaxStep));
  slower_ = std::max(kSlower, kSettling * slower_);
}

void ViewPacer::lost() {
  frames_.lose();
  frames_.send();
}

}  // namespace cyclorama::tour
