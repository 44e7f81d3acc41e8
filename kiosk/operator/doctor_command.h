// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "kiosk/operator/process_link.h"

namespace cyclorama::operations {

/// Returns the processes of this computer that answer status requests, as its units start them: those of a museum, or
/// the coordinator of a render host. The list is empty on a host with nodes only, since nodes do not answer. `root` is
/// the root of the file system.
[[nodiscard]] std::vector<std::string> usual_watches(const std::filesystem::path& root = "/");

/// cyclorama doctor: prints the operator page's list of findings, with remedies.
struct DoctorCommand {
  std::string museum = "/var/lib/cyclorama";
  std::optional<std::string> json;
  bool network = false;

  /// The caller adds --watch and --endpoints as well.
  CLI::App* add_to(CLI::App* app);
  /// Prints the findings. Errors: kUnavailable if something is broken. `ret_exit_code` is 0 or kExitWarnings.
  [[nodiscard]] Status run(const std::vector<ProcessLink>& links, int* ret_exit_code) const;
};
inline constexpr int kExitWarnings = 3;  ///< Exit code for a museum that works but has warnings.

}  // namespace cyclorama::operations
