// SPDX-License-Identifier: Apache-2.0
/// The contents of the museum's state folder: settings in use, the last USB stick, the updater, the opening hours.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/opening/hours_override.h"
#include "kiosk/care/care_settings.h"
#include "kiosk/operator/checks.h"

namespace cyclorama::operations {

/// The folder "/var/lib/cyclorama", written by cyclorama-provision. A value; every call reads the disk again.
struct MuseumState {
  std::filesystem::path root;

  [[nodiscard]] std::filesystem::path settings() const { return root / "settings"; }
  [[nodiscard]] std::filesystem::path site() const { return settings() / "site.toml"; }
  [[nodiscard]] std::filesystem::path care() const { return settings() / care::kCareFile; }
  [[nodiscard]] std::filesystem::path hours_override() const { return root / kHoursOverrideFile; }
  [[nodiscard]] std::filesystem::path pin_file() const { return settings() / "operator-pin"; }
};

struct OpeningSchedule {
  std::vector<std::string> lines;           ///< Hours as in site.toml; none: always open.
  bool is_open = true;                      ///< Present state, including an override while it holds.
  std::string problem;                      ///< Reason why the hours are unknown; empty: they are known.
  std::string zone;                         ///< Time zone of the hours: "Europe/Zurich".
  std::optional<HoursOverride> override{};  ///< Present while an override holds.
  std::string until;             ///< The override's end for people: "22:00", "Wed 25 Nov 10:00"; empty: none holds.
  bool is_until_today = false;   ///< It ends today, in the hours' time zone.
  std::string override_problem;  ///< Reason why the override is ignored; empty: nothing is wrong.
};

[[nodiscard]] OpeningSchedule schedule_of(const MuseumState& museum, WallTime clock);

/// An operator's request to override the hours once.
struct HoursRequest {
  enum class Kind { kOpen, kClosed, kSettings };
  Kind kind = Kind::kSettings;
  std::string until{};  ///< End of kOpen: "22:00".
};
/// Changes the override, which takes effect in the next second in every program that reads the hours. Errors:
/// kInvalidArgument and kUnavailable are those of open_until(); kSystem if the override cannot be written; others if
/// the settings cannot be read.
Status set_hours(const MuseumState& museum, const HoursRequest& wanted, WallTime clock);

/// Returns the museum's name in the settings in use; empty if they name none.
[[nodiscard]] std::string name_of(const MuseumState& museum);
/// Returns the museum's language in the settings in use: "de"; empty if they name none.
[[nodiscard]] std::string language_of(const MuseumState& museum);
/// True if an Authorization header is "Bearer " and the token of [metrics] in care.toml.
[[nodiscard]] bool admits_scraper(const MuseumState& museum, std::string_view authorization);
/// Returns the addresses of the farm's coordinators in the settings in use; none if the settings cannot be read.
[[nodiscard]] std::vector<std::string> farm_of(const MuseumState& museum);
/// Gathers the present input for checks_of().
[[nodiscard]] Findings findings_of(std::vector<ProcessObservation> processes, const MuseumState& museum);

}  // namespace cyclorama::operations
