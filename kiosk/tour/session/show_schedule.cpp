// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/show_schedule.h"

#include <algorithm>

namespace cyclorama::tour {
namespace {

constexpr double kMinHz = 0.1;
constexpr double kMaxHz = 1000.0;
// Margin on the time needed: the last minute's maximum may be exceeded slightly.
constexpr Duration kExtra = std::chrono::milliseconds(2);

std::int64_t second_of(TimePoint t) {
  return std::chrono::duration_cast<std::chrono::seconds>(t.time_since_epoch()).count();
}

}  // namespace

Duration refresh_period_of(const wire::DisplayHello& hello) {
  const double hz = hello.refresh_hz() >= kMinHz && hello.refresh_hz() <= kMaxHz ? hello.refresh_hz() : kMaxHz;
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1.0 / hz));
}

void RecentMaximum::add(Duration value, TimePoint now) {
  const std::int64_t number = second_of(now);
  Second& second = seconds_[static_cast<std::size_t>(number % kSeconds)];
  if (second.number != number) second = {number, value};
  second.longest = std::max(second.longest, value);
}

Duration RecentMaximum::at(TimePoint now) const {
  std::optional<Duration> longest;
  for (const Second& second : seconds_) {
    if (second.number < 0 || second_of(now) - second.number >= kSeconds) continue;
    longest = std::max(second.longest, longest.value_or(second.longest));
  }
  return longest.value_or(at_first_);
}

void ShowSchedule::joined(std::uint64_t display, const wire::DisplayHello& hello) {
  const std::lock_guard lock(mutex_);
  periods_[display] = refresh_period_of(hello);
  choose_period();
}

void ShowSchedule::left(std::uint64_t display) {
  const std::lock_guard lock(mutex_);
  periods_.erase(display);
  choose_period();
}

void ShowSchedule::choose_period() {
  Duration period = std::chrono::milliseconds(1);
  for (const auto& [display, its_period] : periods_) period = std::max(period, its_period);
  if (period == period_) return;
  period_ = period;
  last_frame_ = last_heading_ = 0;  // The numbers of the old period no longer apply.
}

void ShowSchedule::measured(const wire::ClockRequest& question, TimePoint now) {
  const std::lock_guard lock(mutex_);
  const auto add = [now](double need_s, RecentMaximum* longest) {
    // Ignores invalid values and those of a display that is too slow to wait for.
    if (!(need_s > 0.0 && need_s <= to_seconds(kMaxLead))) return;
    longest->add(std::chrono::duration_cast<Duration>(std::chrono::duration<double>(need_s)), now);
  };
  add(question.frame_need_s(), &frame_need_);
  add(question.heading_need_s(), &heading_need_);
}

std::int64_t ShowSchedule::first_refresh(TimePoint now, Duration lead) const {
  return (now.time_since_epoch() + lead + kExtra + period_ - Duration(1)) / period_;
}

wire::ShowAt ShowSchedule::show_at(std::int64_t refresh, TimePoint now) const {
  wire::ShowAt at;
  at.set_refresh(refresh);
  at.set_period_ns(period_.count());
  at.set_told_ns(to_nanoseconds(now));
  return at;
}

std::optional<wire::ShowAt> ShowSchedule::frame_at(TimePoint now) {
  const std::lock_guard lock(mutex_);
  if (!is_shared()) return std::nullopt;
  const std::int64_t first = first_refresh(now, frame_need_.at(now));
  // Chooses the refresh after that of the last frame, even if it is one later than needed, and never an earlier one
  // than that of the last frame when displays have become faster.
  last_frame_ = std::max(first, std::max(last_frame_, std::min(last_frame_ + 1, first + 1)));
  return show_at(last_frame_, now);
}

std::optional<wire::ShowAt> ShowSchedule::heading_at(TimePoint now) {
  const std::lock_guard lock(mutex_);
  if (!is_shared()) return std::nullopt;
  last_heading_ = std::max(last_heading_, first_refresh(now, heading_need_.at(now)));
  return show_at(last_heading_, now);
}

Duration ShowSchedule::frame_lead(TimePoint now) const {
  const std::lock_guard lock(mutex_);
  return is_shared() ? frame_need_.at(now) + kExtra : Duration::zero();
}

Duration ShowSchedule::heading_lead(TimePoint now) const {
  const std::lock_guard lock(mutex_);
  return is_shared() ? heading_need_.at(now) + kExtra : Duration::zero();
}

}  // namespace cyclorama::tour
