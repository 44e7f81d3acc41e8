// SPDX-License-Identifier: Apache-2.0
/// The people of the temple, each as patches at a place.
#pragma once

#include <cstdint>
#include <vector>

#include "renderfarm/generator/sculpture.h"

namespace cyclorama::grotto {

/// A Buddha in meditation on a lotus throne: legs crossed, hands in the lap. In its own frame it is 1 high from the
/// seat to the crown; the throne is below the pose's origin, 0.22 high. `variety` picks robe and nimbus.
[[nodiscard]] std::vector<Patch> seated_buddha(const Pose& pose, std::uint32_t variety, float density);

/// A monk in mourning, standing, 1 high. `variety` picks robe, face and posture.
[[nodiscard]] std::vector<Patch> mourning_disciple(const Pose& pose, std::uint32_t variety, float density);

/// The Buddha entering nirvana, lying on his right side, 10 m long: head at -x, face to +z, his bed the plane y = 0.
/// Pillow and nimbus included.
[[nodiscard]] std::vector<Patch> reclining_buddha(const Pose& pose, float density);

/// The nimbus behind a head or a body: an ellipse with the radii, facing +z in the pose's frame.
[[nodiscard]] Patch nimbus_disc(const Pose& pose, const Vec2& radii, int scheme, float density);

}  // namespace cyclorama::grotto
