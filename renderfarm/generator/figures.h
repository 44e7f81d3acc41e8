// SPDX-License-Identifier: Apache-2.0
/// Statues of the temple; each function returns patches in the given pose.
#pragma once

#include <cstdint>
#include <vector>

#include "renderfarm/generator/sculpture.h"

namespace cyclorama::generator {

/// Returns a Buddha in meditation on a lotus throne: legs crossed, hands in the lap. The pose's scale is the height
/// from the seat to the crown; the throne extends 0.22 of this height below the pose's origin. `variety` selects robe
/// and nimbus.
[[nodiscard]] std::vector<Patch> seated_buddha(const Pose& pose, std::uint32_t variety, float density);

/// Returns a standing monk in mourning; the pose's scale is his height. `variety` selects robe, face and posture.
[[nodiscard]] std::vector<Patch> mourning_disciple(const Pose& pose, std::uint32_t variety, float density);

/// Returns the Buddha entering nirvana, who lies on his right side and is 10 m long: head at -x, face to +z, bed at y =
/// 0. Includes pillow and nimbus.
[[nodiscard]] std::vector<Patch> reclining_buddha(const Pose& pose, float density);

/// Returns the nimbus behind a head or a body: an ellipse with the given radii that faces +z in the pose's frame.
[[nodiscard]] Patch nimbus_disc(const Pose& pose, const Vec2& radii, int scheme, float density);

}  // namespace cyclorama::generator
