// SPDX-License-Identifier: Apache-2.0
/// Slows a visitor down in front of a wall, so that the contact is not felt as a jerk of the picture.
#pragma once

#include <Eigen/Core>

#include "kiosk/tour/navigation/ramp.h"
#include "kiosk/tour/navigation/walkable_area.h"

namespace cyclorama::tour {

/// Returns the maximum speed towards an edge at `distance_m`, in metres per second: the speed that `deceleration` can
/// still stop, and in the last centimetres proportional to the distance, so that the edge is reached without a bump. 0
/// at the edge.
[[nodiscard]] double approach_speed(double distance_m, double deceleration);

/// Current motion along (x, z), in the visitor's metres.
struct Motion {
  Eigen::Vector2d velocity_m_per_s = Eigen::Vector2d::Zero();
  Eigen::Vector2d acceleration_m_per_s2 = Eigen::Vector2d::Zero();
};

/// Returns `desired` (x, z; in the visitor's metres per second) without the components towards edges that could not be
/// stopped in time; the rest slides along the edges. `braking` limits the deceleration, and the reaction time that the
/// present acceleration costs is included. The motion comes to rest kSoftM before an edge. A visitor who glides to rest
/// beside a wall while turning towards it comes about 5 cm nearer without a bump; a visitor who is already nearer is
/// moved away gently. `scale` is in metres of the scene per metre of the visitor.
[[nodiscard]] Eigen::Vector2d braked(const WalkableArea& area, const Eigen::Vector2d& position,
                                     const Eigen::Vector2d& desired, const Motion& motion, const RampLimits& braking,
                                     double scale);
inline constexpr double kSoftM = 0.08;

}  // namespace cyclorama::tour
