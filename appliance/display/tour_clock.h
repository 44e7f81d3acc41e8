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

/// CLOCK_REALTIME, which chrony or PTP disciplines, unlike Clock's time.
using SystemTime = std::chrono::time_point<std::chrono::system_clock, std::chrono::nanoseconds>;
using SystemClock = std::function<SystemTime()>;

/// Estimates the tour's clock: requests the time from the tour a few times a second, and records how long the display
/// needs until it can show what it receives. At most one request is under way; a request without an answer within a
/// second is given up. Thread-safe.
class TourClock {
 public:
  /// Lead of this computer's system clock over the tour's. It need not be small, since pictures follow the measured
  /// clock of the tour; but it is needed to compare logs, and it shows whether this computer's clock is disciplined.
  struct Skew {
    Duration ahead{};
    Duration error{};
  };

  explicit TourClock(SystemClock system_clock) : system_clock_(std::move(system_clock)) {}

  /// Forgets everything, because a new stream may lead to another tour.
  void reset();
  /// Returns the request to send now, if one is due, with the times that the display has needed since the last request.
  std::optional<wire::ClockRequest> question(TimePoint now);
  /// Returns false if `answer` does not belong to the last request.
  bool take(const wire::ClockReply& answer, TimePoint now);

  /// Records that a frame was ready to be shown.
  void frame_ready(const ShowAt& at, TimePoint now);
  void heading_ready(const ShowAt& at, TimePoint now);
  /// Records that drawing began `by` before its synchronised refresh: what it shows must be ready at that time.
  void drawn_ahead(Duration by);

  [[nodiscard]] ClockReading reading(TimePoint now) const;
  [[nodiscard]] std::optional<Skew> skew() const;

 private:
  void add_need(const ShowAt& at, TimePoint now, std::optional<Duration>* need) const;

  const SystemClock system_clock_;
  mutable std::mutex mutex_;  // Guards the members below.
  ClockOffset offset_;
  std::optional<TimePoint> asked_at_;  // Time of the request that has no answer yet.
  TimePoint last_asked_at_{};
  std::optional<Skew> skew_;
  std::optional<Duration> frame_need_;
  std::optional<Duration> heading_need_;
  std::optional<Duration> drawn_ahead_;
};

/// Returns the schedule of `message`; an invalid one counts as none.
[[nodiscard]] ShowAt show_at_of(const wire::ShowMessage& message);

}  // namespace cyclorama::display
