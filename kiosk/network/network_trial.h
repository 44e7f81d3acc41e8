// SPDX-License-Identifier: Apache-2.0
/// Tries network settings for a minute, and takes them back by itself unless somebody confirms them through the network
/// that they made.
///
///   in use ──offer──▶ trying ──confirmed──▶ settings installed ──▶ kept
///                        └──no confirmation, stop, or refused settings──▶ taken back: as in use
///
/// A restart, or a killed process, ends a trial as well: its files lie in RUN, and what the next start reads are the
/// settings in use.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/base/unique_fd.h"

namespace cyclorama::network {

inline constexpr const char* kTrialFile = "cyclorama-network/trial.json";

/// Folders and commands of this computer. A value.
struct NetworkPlace {
  std::filesystem::path run = "/run";
  std::filesystem::path settings = "/etc/cyclorama";  ///< Settings in use.
  std::vector<std::string> reload{};  ///< Command that makes the programs read their files; the changed names follow.
};

struct TrialOrder {
  std::filesystem::path offer;  ///< Folder with another site.toml, and the files that it adds.
  std::string code;             ///< It confirms the trial.
  std::filesystem::path keep;   ///< File in which the confirmation appears: the code.
  Duration length = std::chrono::seconds(60);
  /// Takes the offer into use as the museum's settings, by their own check.
  std::function<Status()> install;
};

enum class TrialEnd { kKept, kTakenBack };

/// Makes the network that the settings in use describe; does nothing while a trial runs, which does so at its end.
/// Errors: those of read_network_settings(), network_files() and the reload.
Status apply_in_use(const NetworkPlace& place);

/// Runs one trial to its end. `stopped` waits until a time, and returns true if the process has to end. Errors: kBusy if
/// a trial runs; those of the offer's settings, before anything has changed; kSystem if the old network cannot be
/// restored.
Result<TrialEnd> run_trial(const NetworkPlace& place, const TrialOrder& order, const Clock& clock,
                           const std::function<bool(TimePoint)>& stopped);

/// A trial's state, for the page.
struct TrialReport {
  std::string state = "none";  ///< "none", "trying", "kept" or "taken-back".
  std::string sentence{};      ///< Reason for the end.
};
/// Returns the report in RUN; "none" if there is none that can be read.
[[nodiscard]] TrialReport read_trial(const std::filesystem::path& run);

}  // namespace cyclorama::network
