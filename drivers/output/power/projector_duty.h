// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "drivers/output/power/pjlink.h"

namespace cyclorama::output {

/// Decides whether one projector must be switched, from its observed and its required state, independently of time.
///
///   required     observed  action
///   on           off       switch on
///   off          on        switch off
///   any          others    query again
///
/// A projector that has reached its required state is left alone until that state changes, since somebody who switches
/// it by hand has a reason. A projector that does not answer may have lost power, so its state is restored once it
/// answers again.
///
/// A value; pure; thread-bound.
class ProjectorDuty {
 public:
  /// `seen` is nothing if the projector did not answer. Returns the state to switch it to, if any.
  std::optional<bool> next(bool should_be_on, std::optional<ProjectorPower> seen);

 private:
  std::optional<bool> done_;  // Last required state that the projector was observed to have.
};

}  // namespace cyclorama::output
