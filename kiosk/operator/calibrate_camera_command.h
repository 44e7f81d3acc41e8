// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "common/base/result.h"

namespace cyclorama::operations {

/// cyclorama calibrate-camera: prints the board; for everything else this process executes cyclorama-calibrate-camera.
struct CalibrateCameraCommand {
  std::optional<std::string> print;
  std::string paper = "a4";

  void add_to(CLI::App* app);
  /// Returns only after printing or on errors: kNotFound if cyclorama-calibrate-camera is missing; others are those of
  /// write_file_atomically().
  [[nodiscard]] Status run(const CLI::App& app) const;
};

}  // namespace cyclorama::operations
