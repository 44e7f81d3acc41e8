// SPDX-License-Identifier: Apache-2.0
/// What there is to be said about a museum: the same list on the operator page and from `cyclorama doctor`.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kiosk/operator/machine_facts.h"
#include "kiosk/operator/observation.h"
#include "kiosk/provision/provisioning_report.h"
#include "kiosk/update/update_status.h"

namespace cyclorama {

enum class Level { kOk, kWarning, kFault };
[[nodiscard]] std::string_view to_text(Level level);  ///< "ok", "warning", "fault".

struct Check {
  std::string id;     ///< "part-tour", "disk": its key in pages and scripts.
  std::string title;  ///< For people: "Tour", "Room on the disk".
  Level level = Level::kOk;
  std::string sentence;  ///< How it is.
  std::string remedy;    ///< What helps; empty when nothing is wrong.
};

/// All that is looked at. A value.
struct Findings {
  std::vector<Observation> processes;
  MachineFacts machine;
  bool is_museum = false;  ///< It has a state folder, so there should be settings in use.
  std::optional<ProvisioningReport> provisioning;
  std::optional<UpdateStatus> update;
  std::chrono::system_clock::time_point now;
};

/// One for each thing that is known; what this computer does not tell is not in it. Pure.
[[nodiscard]] std::vector<Check> checks_of(const Findings& findings);
[[nodiscard]] Level worst_of(const std::vector<Check>& checks);

/// A table for a terminal, the worst first, remedies beneath.
[[nodiscard]] std::string checks_table(const std::vector<Check>& checks);
/// [{"id", "title", "level", "sentence", "remedy"}]
[[nodiscard]] std::string checks_json(const std::vector<Check>& checks);

}  // namespace cyclorama
