// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "appliance/display/frame.h"
#include "common/base/clock_offset.h"
#include "drivers/output/output.h"

namespace cyclorama::display {

/// Gives the output's refreshes the numbers that all displays of a tour count together (wire::ShowAt), and says what is
/// to be seen at the one that is drawn now.
///
///   tour's clock   ──┬───────┬───────┬───────┬──     shared refresh n is at n · period
///                    n      n+1     n+2     n+3
///   this output    ─────┬───────┬───────┬───────      free-running: its refresh takes the nearest number
///                       n      n+1     n+2
///
/// 1. Numbers follow the output's own count, so that neither a late wake-up nor a missed refresh nor a clock's jitter
///    shifts them. Only when an output has drifted past the middle between two numbers, by a tenth of the period more,
///    does it take a number twice or leave one out.
/// 2. So displays that show what is to be seen at a number are apart by their phases alone: less than 1.2 refreshes.
///
/// Thread-bound to the present thread; allocates nothing.
class SynchronisedRefresh {
 public:
  void set_clock(const ClockReading& clock) { clock_ = clock; }
  /// The newest that the tour said: of which period the shared refreshes are, or that there are none.
  void learn(const ShowAt& at) { period_ns_ = at.period_ns; }
  /// A picture is drawn from now on, for the refresh after the last that was shown.
  void begin(TimePoint drawing_at);
  /// Whether it is to be seen in the picture that is drawn. What nothing is said of, or what is too far ahead to be
  /// meant so (of another tour, of another clock), is to be seen at once.
  [[nodiscard]] bool is_due(const ShowAt& at) const;
  /// The output showed what was drawn.
  void shown(const output::Presented& presented, double refresh_hz);

  /// The number of the refresh that is drawn, as all displays count it; where no numbers are shared, as this output
  /// does.
  [[nodiscard]] std::int64_t coming() const { return coming_.value_or(static_cast<std::int64_t>(refresh_) + 1); }
  /// The number of the last refresh shown; nothing where no numbers are shared, or the tour's clock is not known yet.
  [[nodiscard]] std::optional<std::int64_t> number() const { return shown_; }
  /// By how much drawing began before its shared refresh; negative: after it.
  [[nodiscard]] Duration drawn_ahead() const { return drawn_ahead_; }

 private:
  std::optional<std::int64_t> number_at(std::uint64_t refresh, TimePoint at);

  ClockReading clock_;
  std::int64_t period_ns_ = 0;
  // The output: its last refresh, when that was less its jitter, and its rate.
  std::uint64_t refresh_ = 0;
  TimePoint at_{};
  Duration output_period_{};
  int seen_ = 0;
  // Shared number minus the output's.
  std::int64_t shift_ = 0;
  bool is_numbered_ = false;
  std::int64_t numbered_period_ns_ = 0;
  std::optional<std::int64_t> coming_;
  std::optional<std::int64_t> shown_;
  Duration drawn_ahead_{};
};

}  // namespace cyclorama::display
