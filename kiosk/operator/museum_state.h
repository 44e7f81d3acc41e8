// SPDX-License-Identifier: Apache-2.0
/// What the museum's state folder tells: settings in use, the last stick, the updater, the opening hours.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kiosk/operator/checks.h"

namespace cyclorama {

/// "/var/lib/cyclorama" as cyclorama-provision keeps it. A value; every call reads the disk anew.
struct MuseumState {
  std::filesystem::path root;

  [[nodiscard]] std::filesystem::path settings() const { return root / "settings"; }
  [[nodiscard]] std::filesystem::path site() const { return settings() / "site.toml"; }
  [[nodiscard]] std::filesystem::path pin_file() const { return settings() / "operator-pin"; }
};

struct Schedule {
  std::vector<std::string> lines;  ///< As in site.toml; none: always open.
  bool is_open = true;
  std::string problem;  ///< Why they are not known; empty: they are.
};

[[nodiscard]] Schedule schedule_of(const MuseumState& museum, std::chrono::system_clock::time_point now);
/// Addresses of the farm's heads in the settings in use; none where those cannot be read.
[[nodiscard]] std::vector<std::string> farm_of(const MuseumState& museum);
/// Everything for checks_of(), now.
[[nodiscard]] Findings findings_of(std::vector<Observation> processes, const MuseumState& museum);

}  // namespace cyclorama
