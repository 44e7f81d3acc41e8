// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <string>

#include "common/base/result.h"

namespace cyclorama {

/// cyclorama hours: whether the museum is open, and what is said of that for once, as on the operator page.
struct HoursCommand {
  std::string museum = "/var/lib/cyclorama";
  std::string wish;
  std::string until;

  void add_to(CLI::App* app);
  /// Prints how it is then. kInvalidArgument  a time that cannot be, or none. Else as set_hours().
  [[nodiscard]] Status run(std::chrono::system_clock::time_point now) const;
};

}  // namespace cyclorama
