// SPDX-License-Identifier: Apache-2.0
/// Runs another program to its end, with limits on its time and its output.
#pragma once

#include <string>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"

namespace cyclorama {

struct ChildLimits {
  Duration time_limit = std::chrono::seconds(30);  ///< Time after which the child is killed.
  std::size_t max_bytes = 64 * 1024;               ///< Output beyond this is dropped.
};

struct ChildEnd {
  int exit_code = 0;    ///< 128 + the signal's number if a signal ended it.
  std::string output;   ///< Standard output and standard error, in order of arrival.
  bool is_cut = false;  ///< Output exceeded the limit.
};

/// Runs `command`: the program's path, or its name on PATH, and its arguments; there is no shell. Standard input is
/// empty. Blocks until the program ends. Reentrant. Errors: kNotFound or kSystem if it cannot be started; kTimedOut if
/// it was killed at its time limit.
Result<ChildEnd> run_child(const std::vector<std::string>& command, const ChildLimits& limits = {});

}  // namespace cyclorama
