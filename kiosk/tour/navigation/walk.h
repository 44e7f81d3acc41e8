// SPDX-License-Identifier: Apache-2.0
/// How a visitor's wish becomes movement: limited speed, limited acceleration, and never out of the walkable area.
///
///              forward                 The visitor's own frame: right and forward. A heading is positive to the right
///                 ▲                    (clockwise seen from above), and 0 looks along -z of the Scene frame:
///                 │   ╮ turn > 0
///        ─────────●─────────► right      forward = (sin h, -cos h)     right = (cos h, sin h)     as (x, z)
#pragma once

#include <Eigen/Core>

#include "common/base/clock.h"
#include "kiosk/tour/navigation/walkable_area.h"

namespace cyclorama {

/// What somebody asks for, as parts of the limits: each in [-1, 1].
struct SteeringWish {
  double forward = 0.0;
  double right = 0.0;
  double turn = 0.0;  ///< Positive to the right.

  /// With NaN made 0, each part within [-1, 1], and forward and right together at most 1 long.
  [[nodiscard]] SteeringWish limited() const;
  [[nodiscard]] bool is_rest() const { return forward == 0.0 && right == 0.0 && turn == 0.0; }
  friend bool operator==(const SteeringWish&, const SteeringWish&) = default;
};

/// From full speed to rest, so that a lost tag ends in rest within a second; settings are checked for it.
inline constexpr Duration kLongestGlide = std::chrono::milliseconds(650);

/// Of a visitor who walks in the museum; a scene's walking_scale multiplies lengths.
struct WalkLimits {
  double forward_m_per_s = 1.0;
  double sideways_m_per_s = 0.7;
  double turn_rad_per_s = 0.7;  ///< 40 degrees.
  double acceleration_m_per_s2 = 1.6;
  double turn_acceleration_rad_per_s2 = 1.75;  ///< 100 degrees.
};

/// A visitor seen from above, in the Scene frame. A value.
struct Walker {
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();           ///< (x, z).
  double heading_rad = 0.0;                                    ///< Not wrapped, so that it never jumps.
  Eigen::Vector2d velocity_m_per_s = Eigen::Vector2d::Zero();  ///< (right, forward), in the visitor's metres.
  double turn_rate_rad_per_s = 0.0;

  [[nodiscard]] bool is_at_rest() const { return velocity_m_per_s.isZero(0.0) && turn_rate_rad_per_s == 0.0; }
};

[[nodiscard]] Eigen::Vector2d forward_of(double heading_rad);
[[nodiscard]] Eigen::Vector2d right_of(double heading_rad);

/// The walker a moment later. `elapsed` below zero counts as zero, and above kLongestStep as kLongestStep: after a
/// stall the walk goes on instead of leaping. Without an `area` the walker only turns. Where an edge takes speed away,
/// it is gone. Precondition: area == nullptr or area->allows(walker.place_m).
[[nodiscard]] Walker walked(const Walker& walker, const SteeringWish& wish, Duration elapsed, const WalkLimits& limits,
                            double walking_scale, const WalkableArea* area);
inline constexpr Duration kLongestStep = std::chrono::milliseconds(100);

}  // namespace cyclorama
