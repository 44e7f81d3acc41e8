// SPDX-License-Identifier: Apache-2.0
/// Walking up to a wall: slower and slower, so that meeting it is not felt as a jerk of the picture.
#pragma once

#include <Eigen/Core>

#include "kiosk/tour/navigation/ramp.h"
#include "kiosk/tour/navigation/walkable_area.h"

namespace cyclorama {

/// How fast one may go towards an edge that is `distance_m` away: what `deceleration` can still stop, and in the last
/// centimetres ever less, so that it is reached without a bump. Metres per second; 0 at the edge.
[[nodiscard]] double approach_speed(double distance_m, double deceleration);

/// How somebody moves now: x, z; in the visitor's metres.
struct Motion {
  Eigen::Vector2d velocity_m_per_s = Eigen::Vector2d::Zero();
  Eigen::Vector2d acceleration_m_per_s2 = Eigen::Vector2d::Zero();
};

/// `wished` (x, z; in the visitor's metres per second) without those parts towards edges that could not be stopped any
/// more: what remains slides along them. Braking is `braking`'s; what the motion has to do before it brakes is reckoned
/// with. Comes to rest kSoftM before the edges: who glides to rest beside a wall while turning towards it comes some 5
/// cm nearer, and does not bump into it. Who is nearer is led away gently. `scale`: metres of the scene per metre of
/// the visitor.
[[nodiscard]] Eigen::Vector2d braked(const WalkableArea& area, const Eigen::Vector2d& place,
                                     const Eigen::Vector2d& wished, const Motion& motion, const RampLimits& braking,
                                     double scale);
inline constexpr double kSoftM = 0.08;

}  // namespace cyclorama
