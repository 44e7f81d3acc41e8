// SPDX-License-Identifier: Apache-2.0
/// What an operator said of a museum's hours for once: open until a time, or closed for the rest of the day.
///
///   operator page, `cyclorama hours` ──▶ /var/lib/cyclorama/hours/override ──▶ display, projectors, updates
///
/// One line, such as "open from 2026-11-24T17:02:11Z until 2026-11-24T21:00:00Z". It ends by itself: by its end, and by
/// a clock that stands before it was said. No file, one that is broken, or one that has ended: as the settings say.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "common/opening/opening_hours.h"

namespace cyclorama {

inline constexpr const char* kHoursOverrideFile = "hours/override";  ///< In the museum's state folder.
/// Closed from one week's opening day to the next one's, and a clock that is put back.
inline constexpr auto kMaxOverrideDuration = std::chrono::hours(24 * 9);

/// A value. Whole seconds; set_at < until <= set_at + kMaxOverrideDuration, wherever it comes from.
struct HoursOverride {
  bool is_open = true;
  WallTime set_at{};
  WallTime until{};

  [[nodiscard]] bool holds(WallTime now) const { return set_at <= now && now < until; }
  bool operator==(const HoursOverride&) const = default;
};

[[nodiscard]] std::string to_text(const HoursOverride& override);
/// Takes what to_text() makes, and nothing else. kBadData  it is not that.
Result<HoursOverride> parse_hours_override(std::string_view text);
/// Nothing where there is no file. kBadData, kSystem  it cannot be understood or read; then it does not count.
Result<std::optional<HoursOverride>> read_hours_override(const std::filesystem::path& file);

/// Until "HH:MM" by the settings' time zone: the next time that clocks show it, at most 18 hours ahead.
/// kInvalidArgument  no such time, or too far ahead.     kUnavailable  the clock was never set.
Result<HoursOverride> open_until(const OpeningHours& hours, std::string_view time, WallTime now);
/// Until the settings open on a later day; where they never do, or always are, until midnight.
/// kUnavailable  the clock was never set.
Result<HoursOverride> closed_for_today(const OpeningHours& hours, WallTime now);

/// As the override says while it holds, and else as the settings do.
[[nodiscard]] bool is_open(const OpeningHours& hours, const std::optional<HoursOverride>& override, WallTime now);

/// The settings and the file together, for a program that asks often: the file is read once a second. Thread-bound.
class OverriddenHours {
 public:
  /// An empty `file`: there is none.
  explicit OverriddenHours(OpeningHours hours, std::filesystem::path file = {})
      : hours_(std::move(hours)), file_(std::move(file)) {}
  [[nodiscard]] bool is_open(WallTime now);

 private:
  const OpeningHours hours_;
  const std::filesystem::path file_;
  std::optional<HoursOverride> override_;
  std::optional<WallTime> read_at_;
};

}  // namespace cyclorama
