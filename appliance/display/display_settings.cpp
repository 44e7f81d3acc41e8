// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/display_settings.h"

#include <utility>

#include "common/config/config.h"

namespace cyclorama::display {
namespace {

Duration seconds(double s) { return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(s)); }

Result<DisplaySettings> read_from(Config config, const std::filesystem::path& folder) {
  ConfigTable root = config.root();
  // These tables belong to the tour, which checks them.
  for (const char* const others : {"farm", "network", "picture", "tour", "update", "walk"})
    static_cast<void>(root.has(others));
  ConfigTable display = root.table("display");
  DisplaySettings settings;
  const std::string picture = display.text("attract_picture", "");
  if (!picture.empty()) settings.attract_picture = folder / picture;
  const std::string calibration = display.text("calibration", "");
  if (!calibration.empty()) settings.calibration = folder / calibration;
  settings.picture_width_px = display.integer("picture_width_px", {16, 16384}, settings.picture_width_px);
  settings.picture_height_px = display.integer("picture_height_px", {0, 16384}, settings.picture_height_px);
  if (display.has("refresh_hz")) settings.refresh_hz = display.number("refresh_hz", {0.1, 1000.0});
  AttractTimes& times = settings.attract_times;
  times.after = seconds(display.number("attract_after_s", {0.5, 86400.0}, to_seconds(times.after)));
  times.fade = seconds(display.number("attract_fade_s", {0.01, 60.0}, to_seconds(times.fade)));
  settings.hours = read_opening_hours(&root);
  TRY(config.finish());
  return settings;
}

}  // namespace

Result<DisplaySettings> read_display_settings(const std::filesystem::path& path) {
  TRY_ASSIGN(Config config, Config::read(path));
  return read_from(std::move(config), path.parent_path());
}

Result<DisplaySettings> parse_display_settings(std::string_view text, std::string name) {
  TRY_ASSIGN(Config config, Config::parse(text, std::move(name)));
  return read_from(std::move(config), {});
}

}  // namespace cyclorama::display
