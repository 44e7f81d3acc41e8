// SPDX-License-Identifier: Apache-2.0
/// Groups of lamps that can be dimmed while a scene is shown, such as daylight, butter lamps and a torch. Light is
/// linear, so the light of each group is computed alone, and a picture adds them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

namespace cyclorama::scene {

/// Maximum number of groups, with group 0: lamps without a group, glowing surfaces, ambient light, sky and environment.
inline constexpr std::size_t kMaxLampGroups = 8;
inline constexpr std::size_t kMaxLampGroupNameBytes = 64;
/// Upper bound of a level.
inline constexpr float kMaxLampLevel = 4.0f;

/// Factor on the light of each group.
using LampLevels = std::array<float, kMaxLampGroups>;

/// Every lamp as the scene describes it.
inline constexpr LampLevels kAuthoredLamps = {1.0f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f};

/// Returns the levels that show the light of one group alone.
[[nodiscard]] constexpr LampLevels only_group(std::size_t group) {
  LampLevels levels{};
  levels[group] = 1.0f;
  return levels;
}

/// Returns the levels of a view: `named` are those of groups 1 and up; groups that it omits are as authored.
/// Precondition: named.size() < kMaxLampGroups.
[[nodiscard]] constexpr LampLevels levels_of(std::span<const float> named) {
  LampLevels levels = kAuthoredLamps;
  std::ranges::copy(named, levels.begin() + 1);
  return levels;
}

}  // namespace cyclorama::scene
