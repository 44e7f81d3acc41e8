// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/base/result.h"
#include "common/process/stop_signal.h"

namespace cyclorama::watch {

/// Inspection address in the packaged farm.toml: no port listens, and the socket's permissions decide who may watch.
inline constexpr const char* kPackagedInspect = "unix:/run/cyclorama-farm/inspect.sock";

struct TopOptions {
  /// The coordinator's inspection address: "unix:/run/…" or HOST:PORT. Empty selects kPackagedInspect.
  std::string inspect{};
  bool once = false;  ///< Prints one plain table and exits; implied if standard output is not a terminal.
  bool json = false;  ///< Prints status_json() instead of a table, once.
};

/// Runs `cyclorama-farm top`: shows the farm on standard output, every second, until stopped. Errors: kUnavailable or
/// kTimedOut if the coordinator does not answer at the start; on a terminal, later failures are shown and retried.
Status run_top(const TopOptions& options, const StopSignal& stop);

}  // namespace cyclorama::watch
