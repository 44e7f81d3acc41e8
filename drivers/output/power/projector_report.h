// SPDX-License-Identifier: Apache-2.0
/// State of a projector that follows opening hours, in words for the operator.
#pragma once

#include <optional>
#include <string>

#include "common/base/clock.h"
#include "drivers/output/power/pjlink.h"

namespace cyclorama::output {

struct ProjectorReport {
  enum class Level { kOk, kWarning, kFault };
  Level level = Level::kOk;
  std::string sentence;
  std::string remedy;  ///< Empty when nothing is wrong.
};
[[nodiscard]] std::string_view to_text(ProjectorReport::Level level);  ///< "ok", "warning", "fault".

/// Result of one poll of a projector.
struct ProjectorStatus {
  bool should_be_on = false;
  Result<ProjectorPower> power = ProjectorPower::kOff;
  std::optional<ProjectorErrors> errors;  ///< Nothing if the projector does not report them.
};

/// Turns polls into reports. A lamp takes a minute or two to warm up and to cool down, so a state that differs from the
/// required one is reported as a fault only after it has lasted for a while. Thread-bound.
class ProjectorReporter {
 public:
  ProjectorReport see(const ProjectorStatus& look, TimePoint now);

 private:
  struct Condition {
    bool should_be_on = false;
    std::optional<ProjectorPower> power;
    bool operator==(const Condition&) const = default;
  };
  std::optional<Condition> condition_;
  TimePoint since_{};
};

}  // namespace cyclorama::output
