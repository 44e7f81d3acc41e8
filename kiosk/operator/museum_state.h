// SPDX-License-Identifier: Apache-2.0
/// What the museum's state folder tells: settings in use, the last stick, the updater, the opening hours.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/opening/hours_override.h"
#include "kiosk/operator/checks.h"

namespace cyclorama {

/// "/var/lib/cyclorama" as cyclorama-provision keeps it. A value; every call reads the disk anew.
struct MuseumState {
  std::filesystem::path root;

  [[nodiscard]] std::filesystem::path settings() const { return root / "settings"; }
  [[nodiscard]] std::filesystem::path site() const { return settings() / "site.toml"; }
  [[nodiscard]] std::filesystem::path hours_override() const { return root / kHoursOverrideFile; }
  [[nodiscard]] std::filesystem::path pin_file() const { return settings() / "operator-pin"; }
};

struct Schedule {
  std::vector<std::string> lines;           ///< As in site.toml; none: always open.
  bool is_open = true;                      ///< Now, as the override says while it holds.
  std::string problem;                      ///< Why they are not known; empty: they are.
  std::string zone;                         ///< By which times count: "Europe/Zurich".
  std::optional<HoursOverride> override{};  ///< What was said for once, while it holds.
  std::string until;                        ///< Its end for people: "22:00", "Wed 25 Nov 10:00"; empty: none holds.
  std::string override_problem;             ///< Why what was said for once does not count; empty: nothing is wrong.
};

[[nodiscard]] Schedule schedule_of(const MuseumState& museum, WallTime clock);

/// What somebody says of the hours for once.
struct HoursWish {
  enum class Kind { kOpen, kClosed, kSettings };
  Kind kind = Kind::kSettings;
  std::string until{};  ///< "22:00", of kOpen.
};
/// In force from the next second on, in every program that keeps the hours. kInvalidArgument, kUnavailable  as
/// open_until(). kSystem  it cannot be written. Or the settings cannot be read.
Status set_hours(const MuseumState& museum, const HoursWish& wish, WallTime clock);

/// Addresses of the farm's heads in the settings in use; none where those cannot be read.
[[nodiscard]] std::vector<std::string> farm_of(const MuseumState& museum);
/// Everything for checks_of(), now.
[[nodiscard]] Findings findings_of(std::vector<Observation> processes, const MuseumState& museum);

}  // namespace cyclorama
