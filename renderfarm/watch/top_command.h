// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/base/result.h"
#include "common/process/stop_signal.h"

namespace cyclorama {

/// What the package's farm.toml says: no port listens, and who may open the file may look.
inline constexpr const char* kPackagedInspect = "unix:/run/cyclorama-farm/inspect.sock";

struct TopOptions {
  std::string inspect{};  ///< Where the head shows itself: "unix:/run/…" or HOST:PORT. Empty: kPackagedInspect.
  bool once = false;      ///< One plain picture, then the end; always so when standard output is no terminal.
  bool json = false;      ///< status_json() instead of a table; once.
};

/// `cyclorama-farm top`: shows the farm on standard output, again each second, until asked to stop.
/// kUnavailable, kTimedOut  the head does not answer; on a terminal it goes on asking once it has answered.
Status run_top(const TopOptions& options, const StopSignal& stop);

}  // namespace cyclorama
