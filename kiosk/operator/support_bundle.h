// SPDX-License-Identifier: Apache-2.0
/// One file that tells those who are far away how a museum is, and no secret of it.
#pragma once

#include <string>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "kiosk/operator/museum_state.h"

namespace cyclorama {

struct SupportOrder {
  MuseumState museum;
  std::vector<std::string> journal{"journalctl", "--no-pager", "--output=short-iso", "--lines=6000"};
  std::size_t most_journal_bytes = std::size_t{4} << 20;  ///< The newest; what is older is left out.
  Duration longest = std::chrono::seconds(15);            ///< For the journal.
};

/// A ZIP: status.json, checks.json, versions.txt, every .toml and .json of the settings in use and of the state folder,
/// journal.txt. All of it is cleaned (redaction.h); keys, certificates, passwords and pictures are not in it at all.
/// What cannot be had is named in problems.txt. kSystem  the archive cannot be made.
Result<std::string> support_bundle(const SupportOrder& order, const std::string& status_json,
                                   const std::string& checks_json);

}  // namespace cyclorama
