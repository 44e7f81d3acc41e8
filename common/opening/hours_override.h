// SPDX-License-Identifier: Apache-2.0
/// An operator's one-time exception to a museum's hours: open until a time, or closed for the rest of the day.
///
///   operator page, `cyclorama hours` ──▶ /var/lib/cyclorama/hours/override ──▶ display, projectors, updates
///
/// One line, such as "open from 2026-11-24T17:02:11Z until 2026-11-24T21:00:00Z". It is in force from its beginning to
/// its end, so a clock before its beginning ends it, too. Without a file, or with a broken or expired one, the settings
/// apply.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "common/opening/opening_hours.h"

namespace cyclorama {

inline constexpr const char* kHoursOverrideFile = "hours/override";  ///< In the museum's state folder.
/// Covers the time from one week's opening day to the next week's, even if the clock is set back meanwhile.
inline constexpr auto kMaxOverrideDuration = std::chrono::hours(24 * 9);

/// A value. Whole seconds; set_at < until <= set_at + kMaxOverrideDuration, for every source.
struct HoursOverride {
  bool is_open = true;
  WallTime set_at{};
  WallTime until{};

  [[nodiscard]] bool holds(WallTime now) const { return set_at <= now && now < until; }
  bool operator==(const HoursOverride&) const = default;
};

[[nodiscard]] std::string to_text(const HoursOverride& override);
/// Accepts only what to_text() produces. Errors: kBadData for any other text.
Result<HoursOverride> parse_hours_override(std::string_view text);
/// Returns nothing if there is no file. Errors: kBadData or kSystem if it is invalid or cannot be read; then it does
/// not count.
Result<std::optional<HoursOverride>> read_hours_override(const std::filesystem::path& file);

/// Opens until "HH:MM" in the settings' time zone: the next time that clocks show it, at most 18 hours ahead. Errors:
/// kInvalidArgument if there is no such time or it is too far ahead; kUnavailable if the clock was never set.
Result<HoursOverride> open_until(const OpeningHours& hours, std::string_view time, WallTime now);
/// Closes until the settings open on a later day, or until midnight if they never do or are always open. Errors:
/// kUnavailable if the clock was never set.
Result<HoursOverride> closed_for_today(const OpeningHours& hours, WallTime now);

/// Applies the override while it holds, otherwise the settings.
[[nodiscard]] bool is_open(const OpeningHours& hours, const std::optional<HoursOverride>& override, WallTime now);

/// The settings and the file together, for frequent queries: the file is read once a second. Thread-bound.
class OverriddenHours {
 public:
  /// An empty `file` means that there is no override.
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
