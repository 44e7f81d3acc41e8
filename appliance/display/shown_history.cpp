// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/shown_history.h"

#include <algorithm>

#include "appliance/display/present_mailbox.h"

namespace cyclorama::display {
namespace {
constexpr std::size_t kMaxReadyFrames = 12;  // The presenter never holds more frames than this.
}

ShownHistory::ShownHistory(DisplayFrame attract, HeadPlans plans)
    : attract_(std::make_shared<const DisplayFrame>(std::move(attract))), plans_(std::move(plans)) {}

void ShownHistory::frame_ready(const DisplayFrame& frame) {
  auto copy = std::make_shared<const DisplayFrame>(frame);  // Shares the pixels.
  const std::lock_guard lock(mutex_);
  ready_.push_back(std::move(copy));
  if (ready_.size() > kMaxReadyFrames) ready_.pop_front();
}

void ShownHistory::heads_wanted(HeadPlans plans, bool was_passed_over) {
  const std::lock_guard lock(mutex_);
  if (was_passed_over && !coming_.empty()) coming_.pop_back();
  coming_.push_back(std::move(plans));
}

void ShownHistory::heads_changed() {
  const std::lock_guard lock(mutex_);
  if (coming_.empty()) return;
  plans_ = std::move(coming_.front());
  coming_.pop_front();
}

void ShownHistory::refreshed(const RefreshEvent& event, bool is_show) {
  const std::lock_guard lock(mutex_);
  known_until_ = event.presented.at;
  if (event.is_first_of_frame) {
    const auto found = std::ranges::find_if(ready_, [&](const auto& f) { return f->order == event.frame_order; });
    shown_ = found == ready_.end() ? nullptr : *found;
    std::erase_if(ready_, [&](const auto& f) { return f->order <= event.frame_order; });
  }
  ShownSince now;
  now.at = event.presented.at;
  now.plans = plans_;
  // A picture for a moved eye is drawn by the graphics card alone and cannot be computed again by HeadSampler, so it is
  // not reported; nor is the fade of a cut or of a refinement.
  if (is_show && coming_.empty() && event.moved_m == 0.0 && event.cut_share == 0.0 && !event.is_fading_in) {
    if (event.attract_share >= 1.0) now.frame = attract_;
    if (event.attract_share <= 0.0) now.frame = shown_;
    if (now.frame == shown_) now.turn_rad = event.turn_rad;
  }
  if (!moments_.empty()) {
    const ShownSince& before = moments_.back();
    if (before.frame == now.frame && before.plans == now.plans && before.turn_rad == now.turn_rad) return;
  }
  now.number = ++number_;
  moments_.push_back(std::move(now));
  const bool is_asked = known_until_ < asked_at_ + kRequestedWithin;
  while (moments_.size() > 1 && (!is_asked || moments_[1].at + kKept < known_until_)) moments_.pop_front();
}

ShownHistory::Shown ShownHistory::between(TimePoint from, TimePoint until, TimePoint now) {
  const std::lock_guard lock(mutex_);
  asked_at_ = now;
  Shown shown;
  shown.known_until = known_until_;
  for (std::size_t i = 0; i < moments_.size(); ++i) {
    const bool is_over = i + 1 < moments_.size() && moments_[i + 1].at <= from;
    if (!is_over && moments_[i].at <= until) shown.moments.push_back(moments_[i]);
  }
  return shown;
}

}  // namespace cyclorama::display
