// SPDX-License-Identifier: Apache-2.0
/// Times at which a museum's computer looks for updates and restarts for them. From site.toml:
///
///   # site.toml
///   [update]
///   from_farm = true              # false: from USB sticks only.
///   hours = "02:00-05:00"         # Each night, in the time zone of [hours]; never while the museum is open.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "common/base/result.h"
#include "common/opening/hours_override.h"

namespace cyclorama::update {

/// A value; reentrant.
struct UpdateSettings {
  bool from_farm = true;
  bool has_opening_hours = false;
  OpeningHours opening{};
  OpeningHours night{};

  /// True if the clock was set, `now` is within the update hours, and the museum is closed (an override takes
  /// precedence over the opening hours while it holds).
  [[nodiscard]] bool is_night(WallTime now, const std::optional<HoursOverride>& override = std::nullopt) const;
};

/// Ignores the tables of other programs. Errors: those of Config::read() and Config::finish().
Result<UpdateSettings> read_update_settings(const std::filesystem::path& site);
Result<UpdateSettings> parse_update_settings(std::string_view text, const std::string& name);

}  // namespace cyclorama::update
