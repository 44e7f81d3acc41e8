// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "common/base/result.h"

namespace cyclorama::operations {

/// cyclorama sign-stick: signs a USB stick's settings, so that the owner's museums take them without a confirmation.
struct SignStickCommand {
  std::string folder;
  std::string key;

  void add_to(CLI::App* app);
  /// Prints what to do next. Errors: those of provision::sign_stick().
  [[nodiscard]] Status run() const;
};

}  // namespace cyclorama::operations
