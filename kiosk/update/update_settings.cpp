// SPDX-License-Identifier: Apache-2.0
#include "kiosk/update/update_settings.h"

#include <fmt/format.h>

#include <utility>

#include "common/base/text.h"
#include "common/config/config.h"

namespace cyclorama::update {
namespace {

constexpr const char* kUsualNight = "02:00-05:00";

Result<UpdateSettings> settings_of(Config config) {
  UpdateSettings settings;
  ConfigTable root = config.root();
  for (const char* const others : {"display", "farm", "network", "picture", "tour", "walk"})
    static_cast<void>(root.has(others));
  settings.has_opening_hours = root.has("hours");
  std::string zone;
  settings.opening = read_opening_hours(&root, &zone);
  ConfigTable update = root.table("update");
  settings.from_farm = update.flag("from_farm", true);
  const std::string hours = update.text("hours", kUsualNight);
  auto night = OpeningHours::parse({"Mon-Sun " + hours}, zone);
  if (night) {
    settings.night = *std::move(night);
  } else {
    update.refuse("hours",
                  fmt::format("is '{}'; write two times of day, such as \"{}\"", printable(hours), kUsualNight));
  }
  TRY(config.finish());
  return settings;
}

}  // namespace

bool UpdateSettings::is_night(WallTime now, const std::optional<HoursOverride>& override) const {
  // A museum without [hours] is always open but still has update nights, except while an override keeps it open.
  const bool is_overridden = override && override->holds(now);
  const bool is_open = is_overridden ? override->is_open : has_opening_hours && opening.is_open(now);
  return is_clock_set(now) && night.is_open(now) && !is_open;
}

Result<UpdateSettings> read_update_settings(const std::filesystem::path& site) {
  TRY_ASSIGN(Config config, Config::read(site));
  return settings_of(std::move(config));
}

Result<UpdateSettings> parse_update_settings(std::string_view text, const std::string& name) {
  TRY_ASSIGN(Config config, Config::parse(text, name));
  return settings_of(std::move(config));
}

}  // namespace cyclorama::update
