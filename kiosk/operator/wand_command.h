// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "common/base/result.h"

namespace cyclorama {

/// cyclorama wand: what visitors hold, to print and to describe.
struct WandCommand {
  std::optional<std::string> print;
  std::optional<std::string> describe;
  std::string paper = "a4";
  int number = 0;

  void add_to(CLI::App* app);
  /// kInvalidArgument  nothing was asked for.     Others as write_file_atomically().
  [[nodiscard]] Status run() const;
};

}  // namespace cyclorama
