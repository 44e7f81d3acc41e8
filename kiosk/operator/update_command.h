// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "common/base/result.h"
#include "common/process/stop_signal.h"

namespace cyclorama::operations {

/// cyclorama update: does the same as the operator page's button, and prints the result.
struct UpdateCommand {
  std::string requests = "/run/cyclorama-requests";
  std::string museum = "/var/lib/cyclorama";
  double wait_s = 3600.0;

  void add_to(CLI::App* app);
  /// Prints the result. Errors: kNotFound if this computer does not run the museum image; kTimedOut if no answer came;
  /// kUnavailable, with the reason, if the update failed.
  [[nodiscard]] Status run(const StopSignal& stop) const;
};

}  // namespace cyclorama::operations
