// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "common/base/result.h"

namespace cyclorama {

/// cyclorama realign: has the projectors looked for anew while the show goes on, its cameras' places
/// found, or the last correction taken back.
struct RealignCommand {
  std::string calibrator = "[::1]:7410";
  bool places_cameras = false;
  bool undoes = false;

  void add_to(CLI::App* app);
  /// Errors as common/wire/show.proto says.
  [[nodiscard]] Status run() const;
};

}  // namespace cyclorama
