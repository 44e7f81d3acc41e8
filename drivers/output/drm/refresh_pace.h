// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "common/base/clock.h"

namespace cyclorama::output {

/// Counts refreshes by their times, and computes the latest time at which drawing can begin for the next refresh, so
/// that a picture uses the newest possible heading. The allowance is the longest drawing time of the last pictures plus
/// a margin, which each missed refresh doubles. A value; thread-bound.
class RefreshPace {
 public:
  RefreshPace(double refresh_hz, TimePoint now);

  /// Changes the rate after a change of modes; the count continues.
  void set_rate(double refresh_hz);
  [[nodiscard]] double refresh_hz() const { return 1.0 / to_seconds(period_); }

  /// Returns the time at which drawing of the next picture should begin. A card without a vertical blank flips at once,
  /// so drawing begins only when the next refresh is due.
  [[nodiscard]] TimePoint begin_at() const;
  /// Expected time of the next refresh.
  [[nodiscard]] TimePoint next_at() const { return shown_at_ + period_; }

  /// Records the time from the start of drawing to the commit.
  void drawn(Duration took);
  /// Records when the heads showed a picture or, while none is lit, would have shown it. `has_raster`: there is a
  /// vertical blank.
  void shown(TimePoint at, bool has_raster);

  [[nodiscard]] std::uint64_t number() const { return number_; }
  [[nodiscard]] TimePoint shown_at() const { return shown_at_; }

 private:
  Duration period_;
  Duration extra_;
  std::array<Duration, 64> took_{};
  std::size_t next_took_ = 0;
  TimePoint shown_at_;
  std::uint64_t number_ = 0;
  bool has_raster_ = false;
};

}  // namespace cyclorama::output
