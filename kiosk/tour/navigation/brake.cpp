// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/navigation/brake.h"

#include <algorithm>
#include <cmath>

namespace cyclorama::tour {
namespace {

// Near the edge the speed is proportional to the remaining distance: it falls by a factor e in a quarter of a second,
// much more slowly than the ramp that has to follow it (WalkLimits: full acceleration within 0.12 s).
constexpr double kPerSecond = 4.0;
constexpr int kRounds = 3;  // In a corner, removing the component towards one wall adds one towards the other.

}  // namespace

double approach_speed(double distance_m, double deceleration) {
  if (!(distance_m > 0.0)) return 0.0;
  const double linear_m = deceleration / (kPerSecond * kPerSecond);
  if (distance_m <= linear_m) return kPerSecond * distance_m;
  // Continues the linear part with the same slope.
  return std::sqrt(2.0 * deceleration * (distance_m - 0.5 * linear_m));
}

Eigen::Vector2d braked(const WalkableArea& area, const Eigen::Vector2d& position, const Eigen::Vector2d& desired,
                       const Motion& motion, const RampLimits& braking, double scale) {
  Eigen::Vector2d left = desired;
  const double speed = std::max(desired.norm(), motion.velocity_m_per_s.norm());
  if (!(speed > 0.0) || !(braking.acceleration > 0.0)) return left;
  // Beyond this distance even the full speed can be stopped after the maximum reaction time.
  const double reaction_s = (braking.acceleration + motion.acceleration_m_per_s2.norm()) / braking.jerk;
  const double far_m = kSoftM + 0.5 * speed * speed / braking.acceleration +
                       0.5 * braking.acceleration / (kPerSecond * kPerSecond) + 2.0 * speed * reaction_s;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::Vector2d before = left;
    area.for_edges_within(
        position, area.margin_m() + far_m * scale, [&](const Eigen::Vector2d& point, double distance) {
          const Eigen::Vector2d towards = (point - position) / distance;
          const double free_m = (distance - area.margin_m()) / scale - kSoftM;
          const double closing = std::max(0.0, motion.velocity_m_per_s.dot(towards));
          const double gaining = std::max(0.0, motion.acceleration_m_per_s2.dot(towards));
          const double seconds = (braking.acceleration + gaining) / braking.jerk;
          const double reacted_m = free_m - (closing + 0.5 * gaining * seconds) * seconds;
          // Leads away from an edge in the first round only, so that between two edges that are too near to each other
          // nobody is pushed back and forth.
          const double max =
              free_m < 0.0 ? (round == 0 ? kPerSecond * free_m : 0.0) : approach_speed(reacted_m, braking.acceleration);
          const double excess = left.dot(towards) - max;
          if (excess > 0.0) left -= excess * towards;
        });
    if (left == before) break;
  }
  return left;
}

}  // namespace cyclorama::tour
