// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "appliance/display/frame.h"
#include "common/base/clock_offset.h"
#include "drivers/output/output.h"

namespace cyclorama::display {

/// Gives the output's refreshes the numbers that all displays of a tour count together (wire::ShowAt), and decides what
/// is due at the refresh that is drawn now.
///
///   tour's clock   ──┬───────┬───────┬───────┬──     synchronised refresh n is at n · period
///                    n      n+1     n+2     n+3
///   this output    ─────┬───────┬───────┬───────      free-running: its refresh takes the nearest number
///                       n      n+1     n+2
///
/// 1. Numbers follow the output's own count, so that neither a late wake-up nor a missed refresh nor a clock's jitter
///    shifts them. An output repeats or skips a number only after it has drifted a tenth of the period past the middle
///    between two numbers.
/// 2. Displays that show what is due at a number therefore differ by their phases alone: less than 1.2 refreshes.
///
/// Thread-bound to the present thread; allocates nothing.
class SynchronisedRefresh {
 public:
  void set_clock(const ClockReading& clock) { clock_ = clock; }
  /// Takes the tour's newest schedule: the period of its synchronised refreshes; 0 if there are none.
  void learn(const ShowAt& at) { period_ns_ = at.period_ns; }
  /// Begins a picture for the refresh after the one that was shown last.
  void begin(TimePoint drawing_at);
  /// True if `at` is due in the picture that is drawn. An `at` without a schedule, or too far ahead to be plausible (of
  /// another tour or another clock), is due at once.
  [[nodiscard]] bool is_due(const ShowAt& at) const;
  /// Records that the output showed the picture.
  void shown(const output::Presented& presented, double refresh_hz);

  /// Synchronised number of the refresh that is drawn; without synchronised numbers, the output's own number.
  [[nodiscard]] std::int64_t coming() const { return coming_.value_or(static_cast<std::int64_t>(refresh_) + 1); }
  /// Number of the last refresh shown; empty without synchronised numbers, or while the tour's clock is not known.
  [[nodiscard]] std::optional<std::int64_t> number() const { return shown_; }
  /// Time from the start of drawing to the synchronised refresh of the picture; negative if drawing began later.
  [[nodiscard]] Duration drawn_ahead() const { return drawn_ahead_; }

 private:
  std::optional<std::int64_t> number_at(std::uint64_t refresh, TimePoint at);

  ClockReading clock_;
  std::int64_t period_ns_ = 0;
  // Last refresh of the output, the time of that refresh without jitter, and the period of the output's refreshes.
  std::uint64_t refresh_ = 0;
  TimePoint at_{};
  Duration output_period_{};
  int seen_ = 0;
  // Synchronised number of a refresh minus the output's own number.
  std::int64_t shift_ = 0;
  bool is_numbered_ = false;
  std::int64_t numbered_period_ns_ = 0;
  std::optional<std::int64_t> coming_;
  std::optional<std::int64_t> shown_;
  Duration drawn_ahead_{};
};

}  // namespace cyclorama::display
