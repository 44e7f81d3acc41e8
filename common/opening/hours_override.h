// SPDX-License-Identifier: Apache-2.0
/// An operator's one-time exception to a museum's hours: open until a time, or closed for the rest of the day.
///
///   operator page, `cyclorama hours` ──▶ /var/lib/cyclorama/hours/override ──▶ display, projectors, updates
///
/// The file has one line, such as "open from 2026-11-24T17:02:11Z until 2026-11-24T21:00:00Z". The override is in force
/// between these times, so it also ends if the clock is set to a time before its beginning. Without a file, or with a
/// broken or expired one, the settings apply.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "common/opening/opening_hours.h"

namespace cyclorama {

inline constexpr const char* kHoursOverrideFile = "hours/override";  ///< In the museum's state folder.
/// Maximum duration: from an opening day to the same day of the next week, even if the clock is set back meanwhile.
inline constexpr auto kMaxOverrideDuration = std::chrono::hours(24 * 9);

/// An override of the hours. A value. Times have whole seconds; set_at < until <= set_at + kMaxOverrideDuration.
struct HoursOverride {
  bool is_open = true;
  WallTime set_at{};
  WallTime until{};

  [[nodiscard]] bool holds(WallTime now) const { return set_at <= now && now < until; }
  bool operator==(const HoursOverride&) const = default;
};

[[nodiscard]] std::string to_text(const HoursOverride& override);
/// Parses the text that to_text() returns. Errors: kBadData for any other text.
Result<HoursOverride> parse_hours_override(std::string_view text);
/// Reads the override; empty if there is no file. Errors: kBadData or kSystem if the file is invalid or cannot be read;
/// it must then be ignored.
Result<std::optional<HoursOverride>> read_hours_override(const std::filesystem::path& file);

/// Returns an override that opens until "HH:MM" in the settings' time zone: the next time that clocks show it, at most
/// 18 hours ahead. Errors: kInvalidArgument if there is no such time or it is too far ahead; kUnavailable if the clock
/// was never set.
Result<HoursOverride> open_until(const OpeningHours& hours, std::string_view time, WallTime now);
/// Returns an override that closes until the settings open on a later day, or until midnight if they never do or are
/// always open. Errors: kUnavailable if the clock was never set.
Result<HoursOverride> closed_for_today(const OpeningHours& hours, WallTime now);

/// Returns the override's state while it holds, otherwise that of the settings.
[[nodiscard]] bool is_open(const OpeningHours& hours, const std::optional<HoursOverride>& override, WallTime now);

/// The settings and the override's file together, for frequent queries: the file is read once a second. Thread-bound.
class OverriddenHours {
 public:
  /// `file`: the override's file; empty: none.
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
