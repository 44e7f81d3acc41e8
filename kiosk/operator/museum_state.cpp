// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/museum_state.h"

#include <system_error>
#include <utility>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/config/config.h"
#include "common/opening/opening_hours.h"
#include "common/opening/wall_clock.h"

namespace cyclorama {
namespace {
constexpr std::size_t kLargestFile = 256 * 1024;
}

Schedule schedule_of(const MuseumState& museum, std::chrono::system_clock::time_point now) {
  Schedule schedule;
  auto config = Config::read(museum.site());
  const auto hours = read_opening_hours(museum.site());
  if (!config || !hours) {
    schedule.problem = printable((config ? hours.error() : config.error()).message(), 300);
    return schedule;
  }
  for (const std::string& line : config->root().table("hours").texts("open", std::vector<std::string>{}))
    schedule.lines.push_back(printable(line, 100));
  schedule.is_open = hours->is_open(wall_time(now));
  return schedule;
}

std::vector<std::string> farm_of(const MuseumState& museum) {
  auto config = Config::read(museum.site());
  if (!config) return {};
  return config->root().table("farm").texts("heads", std::vector<std::string>{});
}

Findings findings_of(std::vector<Observation> processes, const MuseumState& museum) {
  Findings findings;
  findings.processes = std::move(processes);
  findings.machine = read_machine_facts(museum.root);
  findings.now = std::chrono::system_clock::now();
  std::error_code failed;
  findings.is_museum = std::filesystem::is_directory(museum.root / "generations", failed);
  if (const auto text = read_text_file(museum.root / kProvisioningReportFile, kLargestFile)) {
    if (auto report = parse_report(*text)) findings.provisioning = *std::move(report);
  }
  if (const auto text = read_text_file(museum.root / kUpdateStatusFile, kLargestFile)) {
    if (auto update = parse_update_status(*text)) findings.update = *std::move(update);
  }
  return findings;
}

}  // namespace cyclorama
