// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "common/base/result.h"
#include "common/process/stop_signal.h"
#include "common/wire/calibration.pb.h"

namespace cyclorama::operations {

/// cyclorama calibrate: starts a calibration of the wall and reports the quality of its result.
struct CalibrateCommand {
  std::string calibrator = "[::1]:7410";
  std::optional<std::string> quick;  ///< The only projector to measure; absent: all.
  bool is_resumed = false;
  bool is_restored = false;

  void add_to(CLI::App* app);
  /// Blocks until the calibration ends; a stop signal cancels it, and the previous calibration stays in use. Errors:
  /// kUnavailable if it was cancelled, nobody listens at the address, or a calibration runs already; others are those
  /// defined in common/wire/calibration.proto.
  [[nodiscard]] Status run(const StopSignal& stop) const;
};

/// Returns a readable report of a finished calibration.
[[nodiscard]] std::string calibration_report(const wire::CalibrateDone& done);

}  // namespace cyclorama::operations
