// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <string>

#include "common/base/result.h"

namespace cyclorama::operations {

/// cyclorama hours: reports whether the museum is open, and overrides the hours once, as on the operator page.
struct HoursCommand {
  std::string museum = "/var/lib/cyclorama";
  std::string wanted;
  std::string until;

  void add_to(CLI::App* app);
  /// Prints the resulting state. Errors: kInvalidArgument for an impossible or missing time; others are those of
  /// set_hours().
  [[nodiscard]] Status run(std::chrono::system_clock::time_point now) const;
};

}  // namespace cyclorama::operations
