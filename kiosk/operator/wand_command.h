// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "common/base/result.h"

namespace cyclorama::operations {

/// cyclorama wand: prints and describes a wand.
struct WandCommand {
  std::optional<std::string> print;
  std::optional<std::string> describe;
  std::string paper = "a4";
  int number = 0;

  void add_to(CLI::App* app);
  /// Errors: kInvalidArgument if no output was requested; others are those of write_file_atomically().
  [[nodiscard]] Status run() const;
};

}  // namespace cyclorama::operations
