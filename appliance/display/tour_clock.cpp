// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/tour_clock.h"

#include <algorithm>

namespace cyclorama::display {
namespace {

// The first questions are frequent, so that a display is synchronised within half a second.
constexpr std::uint64_t kFirstQuestions = 16;
constexpr auto kFirstPause = std::chrono::milliseconds(20);
constexpr auto kPause = std::chrono::milliseconds(250);
constexpr auto kGiveUpAfter = std::chrono::seconds(1);
constexpr std::int64_t kMinPeriod_ns = 1'000'000;
constexpr std::int64_t kMaxPeriod_ns = 10'000'000'000;

}  // namespace

ShowAt show_at_of(const wire::ShowMessage& message) {
  const wire::ShowAt& at = message.show_at();
  if (at.period_ns() < kMinPeriod_ns || at.period_ns() > kMaxPeriod_ns) return {};
  const std::int64_t max = kMaxShowAt_ns / at.period_ns();
  if (at.refresh() > max || at.refresh() < -max) return {};
  return {at.refresh(), at.period_ns(), at.told_ns()};
}

void TourClock::reset() {
  const std::lock_guard lock(mutex_);
  offset_.reset();
  asked_at_.reset();
  last_asked_at_ = {};
  skew_.reset();
  frame_need_.reset();
  heading_need_.reset();
}

std::optional<wire::ClockRequest> TourClock::question(TimePoint now) {
  const std::lock_guard lock(mutex_);
  const Duration pause = asked_at_ ? kGiveUpAfter : offset_.count() < kFirstQuestions ? kFirstPause : Duration(kPause);
  if (now - last_asked_at_ < pause) return std::nullopt;
  asked_at_ = last_asked_at_ = now;
  wire::ClockRequest question;
  question.set_asked_ns(to_nanoseconds(now));
  const Duration ahead = drawn_ahead_.value_or(Duration::zero());
  if (frame_need_) question.set_frame_need_s(to_seconds(*frame_need_ + ahead));
  if (heading_need_) question.set_heading_need_s(to_seconds(*heading_need_ + ahead));
  frame_need_.reset();
  heading_need_.reset();
  drawn_ahead_.reset();
  if (skew_) {
    question.set_skew_s(to_seconds(skew_->ahead));
    question.set_skew_error_s(to_seconds(skew_->error));
  }
  return question;
}

bool TourClock::take(const wire::ClockReply& answer, TimePoint now) {
  const SystemTime system_now = system_clock_();
  const std::lock_guard lock(mutex_);
  if (!asked_at_ || to_nanoseconds(*asked_at_) != answer.asked_ns()) return false;
  const TimePoint asked = *std::exchange(asked_at_, std::nullopt);
  if (!offset_.add({asked, answer.received_ns(), answer.answered_ns(), now})) return false;
  const ClockReading reading = offset_.reading(now);
  // Modulo 2^64, since the clocks' values are arbitrary.
  const std::uint64_t since_ns =
      static_cast<std::uint64_t>(reading.at(now)) - static_cast<std::uint64_t>(answer.answered_ns());
  const std::uint64_t tours_ns = static_cast<std::uint64_t>(answer.system_ns()) + since_ns;
  const auto ours_ns = static_cast<std::uint64_t>(system_now.time_since_epoch().count());
  skew_ = Skew{std::chrono::nanoseconds(static_cast<std::int64_t>(ours_ns - tours_ns)), reading.error};
  return true;
}

void TourClock::add_need(const ShowAt& at, TimePoint now, std::optional<Duration>* need) const {
  const ClockReading reading = offset_.reading(now);
  if (at.period_ns == 0 || !reading.is_known) return;
  const std::uint64_t since_ns = static_cast<std::uint64_t>(reading.at(now)) - static_cast<std::uint64_t>(at.told_ns);
  const Duration since = std::chrono::nanoseconds(static_cast<std::int64_t>(since_ns));
  // The schedule belongs to another tour, or is invalid.
  if (since < -kGiveUpAfter || since > 60 * kGiveUpAfter) return;
  *need = std::max(since, need->value_or(Duration::zero()));
}

void TourClock::frame_ready(const ShowAt& at, TimePoint now) {
  const std::lock_guard lock(mutex_);
  add_need(at, now, &frame_need_);
}

void TourClock::heading_ready(const ShowAt& at, TimePoint now) {
  const std::lock_guard lock(mutex_);
  add_need(at, now, &heading_need_);
}

void TourClock::drawn_ahead(Duration by) {
  const std::lock_guard lock(mutex_);
  drawn_ahead_ = std::max(by, drawn_ahead_.value_or(by));
}

ClockReading TourClock::reading(TimePoint now) const {
  const std::lock_guard lock(mutex_);
  return offset_.reading(now);
}

std::optional<TourClock::Skew> TourClock::skew() const {
  const std::lock_guard lock(mutex_);
  return skew_;
}

}  // namespace cyclorama::display
