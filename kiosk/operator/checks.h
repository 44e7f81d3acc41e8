// SPDX-License-Identifier: Apache-2.0
/// The list of findings about a museum: the same on the operator page and from `cyclorama doctor`.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kiosk/operator/hardware_facts.h"
#include "kiosk/operator/machine_facts.h"
#include "kiosk/operator/observation.h"
#include "kiosk/provision/provisioning_report.h"
#include "kiosk/update/update_status.h"

namespace cyclorama::operations {

enum class CheckLevel { kOk, kWarning, kFault };
[[nodiscard]] std::string_view to_text(CheckLevel level);  ///< "ok", "warning", "fault".

struct Check {
  std::string id;     ///< Key in pages and scripts: "part-tour", "disk".
  std::string title;  ///< Title for people: "Tour", "Room on the disk".
  CheckLevel level = CheckLevel::kOk;
  std::string sentence;  ///< The condition found.
  std::string remedy;    ///< Remedy; empty when nothing is wrong.
};

/// Input of the checks. A value.
struct Findings {
  std::vector<ProcessObservation> processes;
  MachineFacts machine;
  HardwareFacts hardware;
  bool is_museum = false;  ///< True if there is a state folder, so that settings should be in use.
  std::optional<provision::ProvisioningReport> provisioning;
  std::optional<update::UpdateStatus> update;
  std::chrono::system_clock::time_point now;
};

/// Returns one check for each known item; items without data are left out. Pure.
[[nodiscard]] std::vector<Check> checks_of(const Findings& findings);
[[nodiscard]] CheckLevel worst_of(const std::vector<Check>& checks);

/// Returns a table for a terminal, the worst first, with remedies beneath.
[[nodiscard]] std::string checks_table(const std::vector<Check>& checks);
/// Returns [{"id", "title", "level", "sentence", "remedy"}].
[[nodiscard]] std::string checks_json(const std::vector<Check>& checks);

}  // namespace cyclorama::operations
