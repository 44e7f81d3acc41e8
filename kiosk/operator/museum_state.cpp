// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/museum_state.h"

#include <openssl/crypto.h>

#include <system_error>
#include <utility>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/config/config.h"
#include "common/opening/opening_hours.h"
#include "common/opening/wall_clock.h"

namespace cyclorama::operations {
namespace {
constexpr std::size_t kMaxFileBytes = 256 * 1024;
constexpr std::size_t kMaxName = 60;
}

OpeningSchedule schedule_of(const MuseumState& museum, WallTime clock) {
  const WallTime now = wall_time(clock);
  OpeningSchedule schedule;
  auto config = Config::read(museum.site());
  const auto hours = read_opening_hours(museum.site());
  if (!config || !hours) {
    schedule.problem = printable((config ? hours.error() : config.error()).message(), 300);
    return schedule;
  }
  for (const std::string& line : config->root().table("hours").texts("open", std::vector<std::string>{}))
    schedule.lines.push_back(printable(line, 100));
  schedule.zone = hours->zone().name();
  const auto override = read_hours_override(museum.hours_override());
  if (!override) schedule.override_problem = printable(override.error().message(), 300);
  if (override && *override && (*override)->holds(now)) {
    schedule.override = *override;
    const absl::Time until = absl::FromChrono((*override)->until);
    schedule.is_until_today =
        absl::ToCivilDay(until, hours->zone()) == absl::ToCivilDay(absl::FromChrono(now), hours->zone());
    schedule.until = absl::FormatTime(schedule.is_until_today ? "%H:%M" : "%a %e %b %H:%M", until, hours->zone());
  }
  schedule.is_open = is_open(*hours, schedule.override, now);
  return schedule;
}

Status set_hours(const MuseumState& museum, const HoursRequest& wanted, WallTime clock) {
  const WallTime now = wall_time(clock);
  std::error_code failed;
  if (wanted.kind == HoursRequest::Kind::kSettings) {
    std::filesystem::remove(museum.hours_override(), failed);
    if (failed) return Error(ErrorCode::kSystem, "removing the override of the hours: " + failed.message());
    return Done{};
  }
  TRY_ASSIGN(const OpeningHours hours, read_opening_hours(museum.site()));
  TRY_ASSIGN(const HoursOverride override, wanted.kind == HoursRequest::Kind::kOpen
                                               ? open_until(hours, wanted.until, now)
                                               : closed_for_today(hours, now));
  // If this fails, the write that follows reports the error.
  std::filesystem::create_directory(museum.hours_override().parent_path(), failed);
  return write_file_atomically(museum.hours_override(), std::string_view(to_text(override)));
}

std::string name_of(const MuseumState& museum) {
  auto config = Config::read(museum.site());
  return config ? printable(config->root().table("farm").text("museum", ""), kMaxName) : "";
}

std::string language_of(const MuseumState& museum) {
  const auto settings = care::read_care_settings(museum.care());
  return settings ? settings->language : "";
}

bool admits_scraper(const MuseumState& museum, std::string_view authorization) {
  constexpr std::string_view kBearer = "Bearer ";
  const auto settings = care::read_care_settings(museum.care());
  if (!settings || settings->metrics_token_file.empty() || !authorization.starts_with(kBearer)) return false;
  const auto token = care::read_secret(settings->metrics_token_file);
  const std::string_view presented = authorization.substr(kBearer.size());
  return token && token->size() >= care::kMinMetricsToken && presented.size() == token->size() &&
         CRYPTO_memcmp(presented.data(), token->data(), token->size()) == 0;
}

std::vector<std::string> farm_of(const MuseumState& museum) {
  auto config = Config::read(museum.site());
  if (!config) return {};
  return config->root().table("farm").texts("coordinators", std::vector<std::string>{});
}

Findings findings_of(std::vector<ProcessObservation> processes, const MuseumState& museum) {
  Findings findings;
  findings.processes = std::move(processes);
  findings.machine = read_machine_facts(museum.root);
  findings.hardware = read_hardware_facts();
  findings.now = std::chrono::system_clock::now();
  std::error_code failed;
  findings.is_museum = std::filesystem::is_directory(museum.root / "generations", failed);
  if (const auto text = read_text_file(museum.root / provision::kProvisioningReportFile, kMaxFileBytes)) {
    if (auto report = provision::parse_report(*text)) findings.provisioning = *std::move(report);
  }
  if (const auto text = read_text_file(museum.root / update::kUpdateStatusFile, kMaxFileBytes)) {
    if (auto update = update::parse_update_status(*text)) findings.update = *std::move(update);
  }
  return findings;
}

}  // namespace cyclorama::operations
