// SPDX-License-Identifier: Apache-2.0
/// When a museum's computer looks for updates, and begins with them. Of site.toml:
///
///   [update]
///   from_farm = true              # false: from sticks alone.
///   hours = "02:00-05:00"         # Each night, by [hours]' time zone; never while the museum is open.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "common/base/result.h"
#include "common/opening/hours_override.h"

namespace cyclorama {

/// A value; reentrant.
struct UpdateSettings {
  bool from_farm = true;
  bool has_opening_hours = false;
  OpeningHours opening{};
  OpeningHours night{};

  /// Within the hours, outside of the opening hours (of what was said for once, while it holds), and by a clock that
  /// was set.
  [[nodiscard]] bool is_night(WallTime now, const std::optional<HoursOverride>& override = std::nullopt) const;
};

/// Other tables are left to other programs. Errors of Config::read() and Config::finish().
Result<UpdateSettings> read_update_settings(const std::filesystem::path& site);
Result<UpdateSettings> parse_update_settings(std::string_view text, const std::string& name);

}  // namespace cyclorama
