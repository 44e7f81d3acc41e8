// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "kiosk/operator/process_link.h"

namespace cyclorama {

/// The processes of this computer that can be asked, as their units start them: a museum's, or a render host's head. A
/// node answers nobody: then none. `root`: of the file system.
[[nodiscard]] std::vector<std::string> usual_watches(const std::filesystem::path& root = "/");

/// cyclorama doctor: the list that the operator page shows, with remedies.
struct DoctorCommand {
  std::string museum = "/var/lib/cyclorama";
  std::optional<std::string> json;
  bool network = false;

  /// Besides these, the caller adds --watch and --endpoints.
  CLI::App* add_to(CLI::App* app);
  /// Prints. kUnavailable  something is broken.     `ret_exit_code`: 0, or kExitWarnings.
  [[nodiscard]] Status run(const std::vector<ProcessLink>& links, int* ret_exit_code) const;
};
inline constexpr int kExitWarnings = 3;  ///< It works, but something should be looked at.

}  // namespace cyclorama
