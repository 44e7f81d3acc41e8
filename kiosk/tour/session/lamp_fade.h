// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"

namespace cyclorama::tour {

/// Levels of the scene's groups of lamps (wire::View.lamp_levels) by name, as a stop or a person sets them.
using LampSettings = std::map<std::string, float>;

inline constexpr float kMaxLampLevel = 4.0f;

/// The levels of a visit's groups of lamps, which follow what is wanted softly. Pure; thread-bound.
class LampFade {
 public:
  /// Time in which a group goes dark or comes back.
  static constexpr Duration kWhole = std::chrono::seconds(2);

  /// Starts with the groups of another scene, which are as the scene describes them.
  void open(std::vector<std::string> groups);
  /// Sets the wanted levels of some groups. Errors: kNotFound, naming the groups that there are, if one is not of the
  /// scene, and kInvalidArgument for a level outside [0, kMaxLampLevel]; nothing changes then.
  Status want(const LampSettings& wanted);
  /// Moves the levels towards those that are wanted, by the time since the last call.
  void step(TimePoint now);

  [[nodiscard]] bool is_moving() const { return levels_ != wanted_; }
  /// Returns the level of each group; empty if all are as the scene describes them.
  [[nodiscard]] std::vector<float> levels() const;
  [[nodiscard]] const std::vector<std::string>& groups() const { return groups_; }

 private:
  std::vector<std::string> groups_;
  std::vector<float> wanted_;
  std::vector<float> levels_;
  TimePoint stepped_at_{};
};

}  // namespace cyclorama::tour
