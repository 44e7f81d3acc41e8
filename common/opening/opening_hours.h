// SPDX-License-Identifier: Apache-2.0
/// When a museum is open: [hours] of site.toml, which several programs read.
///
///   # site.toml
///   [hours]
///   open = ["Tue-Sun 10:00-18:00", "Thu 19:00-22:00", "Fri,Sat 22:00-02:00",
///           "2026-12-24 10:00-14:00", "2026-12-25 closed"]
///   time_zone = "Europe/Zurich"   # Absent: this computer's.
///
/// Lines about the same days add up. A line about a date takes the place of all that is said of its weekday. Hours that
/// end before they begin end on the next day. Without [hours] a museum is always open.
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

/// As people know it; it may jump, and be wrong until the computer's clock was set.
using WallTime = std::chrono::system_clock::time_point;
/// False before 2026, when nobody had this program.
[[nodiscard]] bool is_clock_set(WallTime now);
/// "09:30" in minutes, up to 24:00; nothing: another form.
[[nodiscard]] std::optional<int> time_of_day(std::string_view text);
/// When clocks show a time that something lasts to: where it comes twice, the second; where they jump over it, the
/// jump.
[[nodiscard]] absl::Time end_of(const absl::TimeZone::TimeInfo& info);

/// A value; reentrant.
class OpeningHours {
 public:
  /// Always open.
  OpeningHours() = default;
  /// An empty zone: this computer's. kInvalidArgument  a line or the zone cannot be understood, and what to write.
  static Result<OpeningHours> parse(const std::vector<std::string>& lines, const std::string& time_zone = {});

  /// From what time it is, and from nothing else. Hours count by the clock on the wall: where it jumps ahead over an
  /// hour that they name, that hour is the jump; where an hour comes twice, they begin with the first and end with the
  /// second. True while the clock stands before 2026 (wall_clock.h): a museum whose clock is broken is not dark.
  [[nodiscard]] bool is_open(WallTime now) const;
  /// By which the hours count; this computer's where there are none.
  [[nodiscard]] absl::TimeZone zone() const { return is_always_ ? absl::LocalTimeZone() : zone_; }

 private:
  /// Minutes from a day's beginning; the end may lie in the next day.
  struct Span {
    int from = 0;
    int to = 0;
  };
  Status add(const std::string& line);
  [[nodiscard]] const std::vector<Span>& spans_of(absl::CivilDay day) const;

  bool is_always_ = true;
  std::array<std::vector<Span>, 7> week_;  // From Monday, as absl counts.
  std::map<absl::CivilDay, std::vector<Span>> days_;
  absl::TimeZone zone_;
};

/// [hours] of a site.toml. Mistakes are recorded with the table. `ret_time_zone`, if not null, gets the zone's name, or
/// nothing where it is this computer's.
OpeningHours read_opening_hours(ConfigTable* site, std::string* ret_time_zone = nullptr);
/// The same, of a file whose other tables are left to other programs. Errors of Config::read() and Config::finish().
Result<OpeningHours> read_opening_hours(const std::filesystem::path& site);

}  // namespace cyclorama
