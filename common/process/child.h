// SPDX-License-Identifier: Apache-2.0
/// Another program, run to its end, with limits on its time and on what it says.
#pragma once

#include <string>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"

namespace cyclorama {

struct ChildLimits {
  Duration time_limit = std::chrono::seconds(30);  ///< Then it is killed.
  std::size_t max_bytes = 64 * 1024;               ///< What it says beyond is dropped.
};

struct ChildEnd {
  int exit_code = 0;    ///< 128 + the signal's number where a signal ended it.
  std::string output;   ///< Standard output and standard error, as they came.
  bool is_cut = false;  ///< It said more than the limit.
};

/// `command` is the program's path, or its name on PATH, and its arguments; no shell sees them. Standard input is
/// empty. Blocks until it ends. Reentrant. kNotFound, kSystem  it cannot be started.     kTimedOut  it was killed at
/// its limit.
Result<ChildEnd> run_child(const std::vector<std::string>& command, const ChildLimits& limits = {});

}  // namespace cyclorama
