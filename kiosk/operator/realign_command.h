// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "common/base/result.h"

namespace cyclorama::operations {

/// cyclorama realign: aligns the projectors again while the show continues, locates the fixed cameras, or undoes the
/// last correction.
struct RealignCommand {
  std::string calibrator = "[::1]:7410";
  bool places_cameras = false;
  bool undoes = false;

  void add_to(CLI::App* app);
  /// Errors: those defined in common/wire/show.proto.
  [[nodiscard]] Status run() const;
};

}  // namespace cyclorama::operations
