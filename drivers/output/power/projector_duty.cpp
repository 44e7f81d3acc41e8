// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/power/projector_duty.h"

namespace cyclorama::output {

std::optional<bool> ProjectorDuty::next(bool should_be_on, std::optional<ProjectorPower> seen) {
  if (!seen) done_.reset();
  if (!seen || done_ == should_be_on) return std::nullopt;
  done_.reset();
  // A projector that warms up or cools down accepts no command.
  if (seen != ProjectorPower::kOn && seen != ProjectorPower::kOff) return std::nullopt;
  if ((seen == ProjectorPower::kOn) != should_be_on) return should_be_on;
  done_ = should_be_on;
  return std::nullopt;
}

}  // namespace cyclorama::output
