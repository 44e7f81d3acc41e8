// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "common/base/result.h"
#include "common/process/stop_signal.h"
#include "common/wire/calibration.pb.h"

namespace cyclorama {

/// cyclorama calibrate: has the wall measured, and tells how good it became.
struct CalibrateCommand {
  std::string calibrator = "[::1]:7410";
  std::optional<std::string> quick;  ///< The one projector to measure.
  bool is_resumed = false;
  bool is_restored = false;

  void add_to(CLI::App* app);
  /// Blocks until it is done; a stop cancels it, and then the show is as it was. kUnavailable  it was cancelled, nobody
  /// listens there, or one runs already.     Others as common/wire/calibration.proto says.
  [[nodiscard]] Status run(const StopSignal& stop) const;
};

/// For people: what came of a calibration.
[[nodiscard]] std::string calibration_report(const wire::CalibrateDone& done);

}  // namespace cyclorama
