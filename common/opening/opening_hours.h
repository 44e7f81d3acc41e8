// SPDX-License-Identifier: Apache-2.0
/// When a museum is open: [hours] of site.toml, which several programs read.
///
///   # site.toml
///   [hours]
///   open = ["Tue-Sun 10:00-18:00", "Thu 19:00-22:00", "Fri,Sat 22:00-02:00",
///           "2026-12-24 10:00-14:00", "2026-12-25 closed"]
///   time_zone = "Europe/Zurich"   # Absent: the time zone of this computer.
///
/// Lines about the same days add up. On a date with its own lines, only these count, not those of its weekday. Hours
/// whose end is before their beginning end on the next day. Without [hours] a museum is always open.
#pragma once

#include <absl/time/civil_time.h>
#include <absl/time/time.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/config/config.h"

namespace cyclorama {

/// Civil time. It may jump, and is wrong until the computer's clock was set.
using WallTime = std::chrono::system_clock::time_point;
/// False before 2026, when this program did not exist yet.
[[nodiscard]] bool is_clock_set(WallTime now);
/// Parses a time such as "09:30", up to "24:00", to minutes since midnight; empty for another form.
[[nodiscard]] std::optional<int> time_of_day(std::string_view text);
/// Returns the instant at which a period ends that lasts until a civil time: the second instant if clocks show that
/// time twice, or the jump if clocks skip it.
[[nodiscard]] absl::Time end_of(const absl::TimeZone::TimeInfo& info);

/// A museum's hours. A value; reentrant.
class OpeningHours {
 public:
  /// Constructs hours that are always open.
  OpeningHours() = default;
  /// Parses the lines of [hours]. Without `time_zone`, times are in the zone of this computer. Errors:
  /// kInvalidArgument, with a remedy, if a line or the zone is invalid.
  static Result<OpeningHours> parse(const std::vector<std::string>& lines, const std::string& time_zone = {});

  /// Depends on `now` only. Hours are civil time. Where clocks skip an hour that the settings name, the moment of the
  /// jump counts instead; where an hour occurs twice, opening uses the first and closing the second. True while the
  /// clock is before 2026 (wall_clock.h), so that a museum with a broken clock is not dark.
  [[nodiscard]] bool is_open(WallTime now) const;
  /// Time zone of the hours; that of this computer if there are no hours.
  [[nodiscard]] absl::TimeZone zone() const { return is_always_ ? absl::LocalTimeZone() : zone_; }

 private:
  /// Minutes since the day began; the end may lie in the next day.
  struct Span {
    int from = 0;
    int to = 0;
  };
  Status add(const std::string& line);
  [[nodiscard]] const std::vector<Span>& spans_of(absl::CivilDay day) const;

  bool is_always_ = true;
  std::array<std::vector<Span>, 7> week_;  // Begins with Monday, as in absl.
  std::map<absl::CivilDay, std::vector<Span>> days_;
  absl::TimeZone zone_;
};

/// Reads [hours] of a site.toml. Mistakes are recorded in the table. `ret_time_zone`, if not null, receives the zone's
/// name; empty for the zone of this computer.
OpeningHours read_opening_hours(ConfigTable* site, std::string* ret_time_zone = nullptr);
/// Reads the hours of a file and ignores its other tables. Errors: those of Config::read() and Config::finish().
Result<OpeningHours> read_opening_hours(const std::filesystem::path& site);

}  // namespace cyclorama
