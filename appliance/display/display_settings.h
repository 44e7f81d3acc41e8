// SPDX-License-Identifier: Apache-2.0
/// The display's part of site.toml; the tour reads the rest of the same file. Every setting has a default, and the file
/// may be absent. Outside of [hours] (opening_hours.h) the heads are dark.
///
///   # site.toml
///   [display]
///   attract_picture = "attract.jpg"   # PNG or JPEG, sought in site.toml's folder; absent: an evening sky.
///   attract_after_s = 20              # Seconds that a wrong picture stays before the attract picture fades in.
///   attract_fade_s = 2                # Seconds that the fade lasts.
///   calibration = "calibration"       # A calibration's folder, in the same folder; absent: as installed.
///   picture_width_px = 1024           # Size of the picture from the farm; all projectors together show it.
///   picture_height_px = 0             # 0: such that pixels are square.
///   refresh_hz = 50                   # Refresh rate of the projectors; absent: 60, or 30 without projectors.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "appliance/display/attract_fade.h"
#include "common/base/result.h"
#include "common/opening/opening_hours.h"

namespace cyclorama::display {

struct DisplaySettings {
  std::filesystem::path attract_picture;  ///< Empty: the built-in picture.
  AttractTimes attract_times;
  std::filesystem::path calibration;  ///< Empty: there is none.
  int picture_width_px = 1024;        ///< 16 to 16384.
  int picture_height_px = 0;          ///< 0: such that pixels are square.
  std::optional<double> refresh_hz;   ///< 0.1 to 1000; absent: the output's default.
  OpeningHours hours;
};

/// Reads site.toml. Errors: those of Config::read().
Result<DisplaySettings> read_display_settings(const std::filesystem::path& path);
/// Parses `text`; `name` stands for the file in errors.
Result<DisplaySettings> parse_display_settings(std::string_view text, std::string name);

}  // namespace cyclorama::display
