// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <optional>

#include "appliance/display/frame.h"
#include "common/base/clock_offset.h"
#include "common/wire/museum.pb.h"

namespace cyclorama::display {

/// CLOCK_REALTIME, which chrony or PTP disciplines, unlike Clock's.
using SystemTime = std::chrono::time_point<std::chrono::system_clock, std::chrono::nanoseconds>;
using SystemClock = std::function<SystemTime()>;

/// The tour's clock as this display knows it: asks the tour for the time a few times a second, and gathers what the
/// display needs until it can show what it is told. One question is on its way at a time; one that has no answer within
/// a second is given up. Thread-safe.
class TourClock {
 public:
  /// How far this computer's system clock is before the tour's. It need not be small: what is shown follows the tour's
  /// clock as measured. Yet logs are compared by it, and it tells whether this computer's clock is disciplined.
  struct Skew {
    Duration ahead{};
    Duration error{};
  };

  explicit TourClock(SystemClock system_clock) : system_clock_(std::move(system_clock)) {}

  /// Another stream: perhaps another tour. Nothing is known any more.
  void reset();
  /// A question to be sent now, if it is time for one, with what was needed since the last.
  std::optional<wire::ClockQuestion> question(TimePoint now);
  /// False when it is no answer to the last question.
  bool take(const wire::ClockAnswer& answer, TimePoint now);

  /// Something was ready to be shown.
  void frame_ready(const ShowAt& at, TimePoint now);
  void heading_ready(const ShowAt& at, TimePoint now);
  /// A picture was begun by so much before its shared refresh: what it shows must have been ready then.
  void drawn_ahead(Duration by);

  [[nodiscard]] ClockReading reading(TimePoint now) const;
  [[nodiscard]] std::optional<Skew> skew() const;

 private:
  void add_need(const ShowAt& at, TimePoint now, std::optional<Duration>* need) const;

  const SystemClock system_clock_;
  mutable std::mutex mutex_;  // Guards the following.
  ClockOffset offset_;
  std::optional<TimePoint> asked_at_;  // Of the question that has no answer yet.
  TimePoint last_asked_at_{};
  std::optional<Skew> skew_;
  std::optional<Duration> frame_need_;
  std::optional<Duration> heading_need_;
  std::optional<Duration> drawn_ahead_;
};

/// What is wrong is none.
[[nodiscard]] ShowAt show_at_of(const wire::ShowMessage& message);

}  // namespace cyclorama::display
