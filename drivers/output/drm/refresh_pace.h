// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "common/base/clock.h"

namespace cyclorama::output {

/// Counts refreshes by their times, and says how late a picture may be begun so that it still makes the next one: the
/// newest heading is then the least old. The allowance is what the slowest of the last pictures took and some more; a
/// refresh that was missed doubles it. A value; thread-bound.
class RefreshPace {
 public:
  RefreshPace(double refresh_hz, TimePoint now);

  /// Of other modes; the count goes on.
  void set_rate(double refresh_hz);
  [[nodiscard]] double refresh_hz() const { return 1.0 / to_seconds(period_); }

  /// When the next picture should be begun. A card without a raster flips when it is told to, hence only when the next
  /// refresh is due.
  [[nodiscard]] TimePoint begin_at() const;
  /// When the next refresh is expected.
  [[nodiscard]] TimePoint next_at() const { return shown_at_ + period_; }

  /// From the time a picture was begun to when it was handed to the card.
  void drawn(Duration took);
  /// The heads began to show something, or would have.
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
