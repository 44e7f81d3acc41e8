// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "kiosk/care/alarm_registry.h"

namespace cyclorama::care {

/// Counts the visits of each day and their time; it has no picture, and nothing about a person. A
/// visit lasts while somebody steers, and ends a minute after; shorter ones than five seconds are none. Pure; its state
/// outlives restarts as JSON. Thread-bound.
class VisitCounts {
 public:
  struct Day {
    int visits = 0;
    double seconds = 0.0;
    friend bool operator==(const Day&, const Day&) = default;
  };
  static constexpr std::size_t kMaxDays = 400;

  /// Takes whether somebody steers now; `day` is today's date in the museum's time zone, "2026-11-25".
  void update(bool is_steered, WallSeconds now, const std::string& day);

  /// Days with visits, the oldest first; at most kMaxDays.
  [[nodiscard]] const std::map<std::string, Day>& days() const { return days_; }
  /// Sums since the first day, also of days that were dropped.
  [[nodiscard]] const Day& total() const { return total_; }
  [[nodiscard]] bool is_visited() const { return began_.has_value(); }

  [[nodiscard]] std::string to_json() const;
  /// Replaces the state. Errors: kBadData with position and mistake; the state is then as before.
  Status read_json(std::string_view text, const std::string& name);

 private:
  std::map<std::string, Day> days_;
  Day total_;
  std::optional<WallSeconds> began_;  ///< Begin of the present visit.
  WallSeconds steered_{};             ///< Last time at which somebody steered.
};

}  // namespace cyclorama::care
