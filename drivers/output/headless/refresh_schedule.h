// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/base/clock.h"

namespace cyclorama::output {

/// When a head without a vertical blank refreshes: refresh n is at start + n / refresh_hz, for ever, whatever happened
/// before, so that nothing drifts. A value; thread-bound.
class RefreshSchedule {
 public:
  struct Refresh {
    std::uint64_t number = 0;
    TimePoint at{};
  };

  /// Precondition: refresh_hz > 0. Refresh 0 is at `start`.
  RefreshSchedule(double refresh_hz, TimePoint start);

  /// The next refresh to wait for: the one after the last that this returned, or, when `now` has passed that one's end,
  /// the next that is still to come. Numbers that are skipped were missed.
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
