// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/base/result.h"
#include "common/process/stop_signal.h"

namespace cyclorama::watch {

/// Setting of the packaged farm.toml: no port listens; the file's permissions decide who may watch.
inline constexpr const char* kPackagedInspect = "unix:/run/cyclorama-farm/inspect.sock";

struct TopOptions {
  /// The coordinator's inspection address: "unix:/run/…" or HOST:PORT. Empty: kPackagedInspect.
  std::string inspect{};
  bool once = false;  ///< Prints one plain table and exits; always if standard output is not a terminal.
  bool json = false;  ///< Prints status_json() instead of a table, once.
};

/// `cyclorama-farm top`: shows the farm on standard output, every second, until stopped. Errors: kUnavailable or
/// kTimedOut if the coordinator does not answer; on a terminal it keeps trying once it has had an answer.
Status run_top(const TopOptions& options, const StopSignal& stop);

}  // namespace cyclorama::watch
