// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "common/base/result.h"

namespace cyclorama {

/// cyclorama realign: has the projectors looked for anew while the show goes on, or its cameras' places found.
struct RealignCommand {
  std::string calibrator = "[::1]:7410";
  bool places_cameras = false;

  void add_to(CLI::App* app);
  /// Errors as common/wire/show.proto says.
  [[nodiscard]] Status run() const;
};

}  // namespace cyclorama
