// SPDX-License-Identifier: Apache-2.0
/// Turns steering commands into movement with limited speed, acceleration and jerk, slower towards walls, and never
/// outside the walkable area.
///
///              forward                 The visitor's own frame: right and forward. A heading is positive to the right
///                 ▲                    (clockwise seen from above), and 0 looks along -z of the Scene frame:
///                 │   ╮ turn > 0
///        ─────────●─────────► right      forward = (sin h, -cos h)     right = (cos h, sin h)     as (x, z)
#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "common/base/clock.h"
#include "kiosk/tour/navigation/comfort.h"
#include "kiosk/tour/navigation/ramp.h"
#include "kiosk/tour/navigation/walkable_area.h"

namespace cyclorama::tour {

/// A steering command, in fractions of the limits: each component in [-1, 1].
struct SteeringCommand {
  double forward = 0.0;
  double right = 0.0;
  double turn = 0.0;  ///< Positive to the right.

  /// Returns the command with NaN replaced by 0, each component within [-1, 1], and (forward, right) at most 1 long.
  [[nodiscard]] SteeringCommand limited() const;
  [[nodiscard]] bool is_rest() const { return forward == 0.0 && right == 0.0 && turn == 0.0; }
  friend bool operator==(const SteeringCommand&, const SteeringCommand&) = default;
};

/// Maximum time from a command to stop until the visitor is at rest, so that a lost tag leads to rest within a second.
/// Settings are checked against it with max_stop_s().
inline constexpr Duration kMaxGlide = std::chrono::milliseconds(700);

/// Limits of a visitor who walks in the museum; a scene's walking_scale multiplies lengths.
struct WalkLimits {
  double forward_m_per_s = kComfort.speed_m_per_s;
  double sideways_m_per_s = 0.7 * kComfort.speed_m_per_s;
  double turn_rad_per_s = kComfort.turn_rad_per_s;
  /// Acceleration limit of the faster of forward and sideways. The slower one is scaled by the ratio of the speeds, so
  /// that both start and stop together, and a straight path is straight from its first step.
  double acceleration_m_per_s2 = kComfort.acceleration_m_per_s2;
  double jerk_m_per_s3 = kComfort.jerk_m_per_s3;
  double turn_acceleration_rad_per_s2 = kComfort.turn_acceleration_rad_per_s2;
  double turn_jerk_rad_per_s3 = kComfort.turn_jerk_rad_per_s3;

  [[nodiscard]] RampLimits forward() const { return share_of(forward_m_per_s); }
  [[nodiscard]] RampLimits sideways() const { return share_of(sideways_m_per_s); }
  [[nodiscard]] RampLimits turning() const { return {turn_acceleration_rad_per_s2, turn_jerk_rad_per_s3}; }

 private:
  /// The share is at least a hundredth: a visitor who may not walk sideways must still stop after sliding along a wall.
  [[nodiscard]] RampLimits share_of(double speed) const {
    const double fastest = std::max(forward_m_per_s, sideways_m_per_s);
    const double share = fastest > 0.0 ? std::max(speed / fastest, 0.01) : 1.0;
    return {share * acceleration_m_per_s2, share * jerk_m_per_s3};
  }
};

/// A visitor seen from above, in the Scene frame. A value.
struct Walker {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();        ///< (x, z) in metres.
  double heading_rad = 0.0;                                    ///< Not wrapped, so that it never jumps.
  Eigen::Vector2d velocity_m_per_s = Eigen::Vector2d::Zero();  ///< (right, forward), in the visitor's metres.
  double turn_rate_rad_per_s = 0.0;
  /// (right, forward), at the end of the last step.
  Eigen::Vector2d acceleration_m_per_s2 = Eigen::Vector2d::Zero();
  double turn_acceleration_rad_per_s2 = 0.0;

  [[nodiscard]] bool is_at_rest() const {
    return velocity_m_per_s.isZero(0.0) && turn_rate_rad_per_s == 0.0 && acceleration_m_per_s2.isZero(0.0) &&
           turn_acceleration_rad_per_s2 == 0.0;
  }
};

[[nodiscard]] Eigen::Vector2d forward_of(double heading_rad);
[[nodiscard]] Eigen::Vector2d right_of(double heading_rad);

/// Returns the walker after `elapsed`, which is clamped to [0, kMaxStep]: after a stall the walk continues instead
/// of leaping. Without an `area` the walker only turns. The walker slows down before an edge (brake.h); an edge that
/// the walker still meets removes the speed perpendicular to the edge. Precondition: area == nullptr or
/// area->allows(walker.position_m).
[[nodiscard]] Walker walked(const Walker& walker, const SteeringCommand& command, Duration elapsed,
                            const WalkLimits& limits, double walking_scale, const WalkableArea* area);
inline constexpr Duration kMaxStep = std::chrono::milliseconds(100);

}  // namespace cyclorama::tour
