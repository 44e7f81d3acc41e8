// SPDX-License-Identifier: Apache-2.0
/// One file that describes a museum to remote support, without its secrets.
#pragma once

#include <string>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "kiosk/operator/museum_state.h"

namespace cyclorama::operations {

struct SupportOrder {
  MuseumState museum;
  std::vector<std::string> journal{"journalctl", "--no-pager", "--output=short-iso", "--lines=6000"};
  std::size_t max_journal_bytes = std::size_t{4} << 20;  ///< Maximum size; older lines are left out.
  Duration longest = std::chrono::seconds(15);           ///< Timeout of the journal command.
};

/// Returns a ZIP: status.json, checks.json, versions.txt, every .toml and .json of the settings in use and of the state
/// folder, journal.txt. All texts are redacted (redaction.h); keys, certificates, passwords and pictures are left out.
/// problems.txt lists what could not be included. Errors: kSystem if the archive cannot be made.
Result<std::string> support_bundle(const SupportOrder& order, const std::string& status_json,
                                   const std::string& checks_json);

}  // namespace cyclorama::operations
