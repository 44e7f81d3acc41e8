// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/hours_command.h"

#include <fmt/format.h>

#include <cstdio>

#include "kiosk/operator/museum_state.h"

namespace cyclorama::operations {
namespace {

std::string text_of(const OpeningSchedule& schedule) {
  std::string text = schedule.is_open ? "Open now" : "Closed now";
  if (schedule.override) {
    text += fmt::format(" until {} ({}), by an override; then as the settings say", schedule.until, schedule.zone);
  }
  text += ".\n";
  if (!schedule.override_problem.empty()) text += fmt::format("As the settings say: {}.\n", schedule.override_problem);
  for (const std::string& line : schedule.lines) text += "  " + line + "\n";
  if (schedule.lines.empty()) text += "  The settings say: always open.\n";
  return text;
}

}  // namespace

void HoursCommand::add_to(CLI::App* app) {
  CLI::App& command = *app->add_subcommand(
      "hours", "Show whether the museum is open; or open it once until a time, or close it once for today");
  command
      .add_option("ACTION", wanted,
                  "open TIME: until then; closed: until it opens on a later day; settings: as configured; none: "
                  "only show")
      ->check(CLI::IsMember({"open", "closed", "settings"}));
  command.add_option("TIME", until, "Such as 22:00, in the museum's time zone");
  command.add_option("--museum", museum, "The museum's state folder")->capture_default_str();
}

Status HoursCommand::run(std::chrono::system_clock::time_point now) const {
  const MuseumState state{museum};
  if ((wanted == "open") == until.empty()) {
    return Error(ErrorCode::kInvalidArgument,
                 wanted == "open" ? "say until when: cyclorama hours open 22:00" : "a time goes with 'open' alone");
  }
  if (wanted == "open") TRY(set_hours(state, {HoursRequest::Kind::kOpen, until}, now));
  if (wanted == "closed") TRY(set_hours(state, {HoursRequest::Kind::kClosed}, now));
  if (wanted == "settings") TRY(set_hours(state, {HoursRequest::Kind::kSettings}, now));
  const OpeningSchedule schedule = schedule_of(state, now);
  if (!schedule.problem.empty()) return Error(ErrorCode::kUnavailable, schedule.problem);
  std::fputs(text_of(schedule).c_str(), stdout);
  return Done{};
}

}  // namespace cyclorama::operations
