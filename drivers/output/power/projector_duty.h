// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "drivers/output/power/pjlink.h"

namespace cyclorama::output {

/// Whether one projector must be switched, from how it is and how it should be now; nothing is remembered of times.
///
///   should be    seen      done
///   on           off       switched on        A projector that has been as it should is left alone until that changes:
///   off          on        switched off       whoever switches it by hand meanwhile has a reason. One that did not
///   any          others    asked again        answer may have been without power: it is made right again.
///
/// A value; pure; thread-bound.
class ProjectorDuty {
 public:
  /// `seen`: nothing if it did not answer. Returns what to switch it to.
  std::optional<bool> next(bool should_be_on, std::optional<ProjectorPower> seen);

 private:
  std::optional<bool> done_;  // What it has been made, and answered to be.
};

}  // namespace cyclorama::output
