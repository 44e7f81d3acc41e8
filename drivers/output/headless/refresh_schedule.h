// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/base/clock.h"

namespace cyclorama::output {

/// Refresh times of a head without a vertical blank: refresh n is always at start + n / refresh_hz, so that delays do
/// not accumulate. A value; thread-bound.
class RefreshSchedule {
 public:
  struct Refresh {
    std::uint64_t number = 0;
    TimePoint at{};
  };

  /// Precondition: refresh_hz > 0. Refresh 0 is at `start`.
  RefreshSchedule(double refresh_hz, TimePoint start);

  /// Returns the next refresh to wait for: the successor of the last one returned or, if that successor is over at
  /// `now`, the first one that is not before `now`. Skipped numbers are missed refreshes.
  Refresh next(TimePoint now);
  [[nodiscard]] std::uint64_t missed() const { return missed_; }

 private:
  [[nodiscard]] TimePoint time_of(std::uint64_t number) const;

  double period_s_;
  TimePoint start_;
  std::uint64_t next_number_ = 0;
  std::uint64_t missed_ = 0;
};

}  // namespace cyclorama::output
