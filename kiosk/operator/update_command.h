// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "common/base/result.h"
#include "common/process/stop_signal.h"

namespace cyclorama {

/// cyclorama update: what the operator page's button does, and what came of it.
struct UpdateCommand {
  std::string wishes = "/run/cyclorama-wishes";
  std::string museum = "/var/lib/cyclorama";
  double wait_s = 3600.0;

  void add_to(CLI::App* app);
  /// Prints. kNotFound  this computer's software is not kept by the museum image.     kTimedOut  no answer came.
  /// kUnavailable  it came to nothing, and why.
  [[nodiscard]] Status run(const StopSignal& stop) const;
};

}  // namespace cyclorama
