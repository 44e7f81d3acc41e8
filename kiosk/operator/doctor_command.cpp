// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/doctor_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <system_error>

#include "common/base/file.h"
#include "kiosk/operator/museum_state.h"
#include "kiosk/operator/network_test.h"

namespace cyclorama::operations {

std::vector<std::string> usual_watches(const std::filesystem::path& root) {
  std::error_code failed;
  const bool has_coordinator = std::filesystem::exists(root / "run/cyclorama-farm/inspect.sock", failed);
  const bool has_node = std::filesystem::exists(root / "usr/bin/cyclorama-node", failed);
  const bool is_museum = std::filesystem::exists(root / "usr/bin/cyclorama-tour", failed);
  if (!is_museum && (has_coordinator || has_node))
    return has_coordinator ? std::vector<std::string>{"coordinator=unix:/run/cyclorama-farm/inspect.sock"}
                           : std::vector<std::string>{};
  return {"tour=[::1]:7403", "display=[::1]:7404", "tracker=[::1]:7405"};
}

CLI::App* DoctorCommand::add_to(CLI::App* app) {
  CLI::App* const doctor = app->add_subcommand(
      "doctor", "List what works and what does not, with remedies; exit status 0: all well, 3: warnings, 1: broken");
  doctor->add_option("--museum", museum, "The museum's state folder")->capture_default_str();
  doctor->add_flag("--network", network, "Also test the connection to the farm; takes some seconds");
  doctor->add_option("--json", json, "Also write the list to this file");
  return doctor;
}

Status DoctorCommand::run(const std::vector<ProcessLink>& links, int* ret_exit_code) const {
  const MuseumState state{museum};
  std::vector<ProcessObservation> processes;
  for (const ProcessLink& link : links) processes.push_back(observe(link, {}));
  const Findings findings = findings_of(std::move(processes), state);
  std::vector<Check> checks = checks_of(findings);
  if (network) {
    for (Check& check : test_network(farm_of(state), findings.machine)) checks.push_back(std::move(check));
  }
  std::fputs(checks_table(checks).c_str(), stdout);
  if (json) TRY(write_file_atomically(*json, std::string_view(checks_json(checks) + "\n")));
  const CheckLevel worst = worst_of(checks);
  *ret_exit_code = worst == CheckLevel::kWarning ? kExitWarnings : 0;
  if (worst != CheckLevel::kFault) return Done{};
  const auto faults =
      std::count_if(checks.begin(), checks.end(), [](const Check& c) { return c.level == CheckLevel::kFault; });
  return Error(ErrorCode::kUnavailable, fmt::format("{} thing{} broken", faults, faults == 1 ? " is" : "s are"));
}

}  // namespace cyclorama::operations
