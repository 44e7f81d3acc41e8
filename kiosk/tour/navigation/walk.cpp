// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/navigation/walk.h"

#include <algorithm>
#include <cmath>

#include "kiosk/tour/navigation/brake.h"

namespace cyclorama::tour {
namespace {

using Eigen::Vector2d;

double part_of(double value) { return std::isnan(value) ? 0.0 : std::clamp(value, -1.0, 1.0); }

constexpr double kMinSpeed = 0.05;  // A visitor who may not walk at all is still led out of a corner.

// Fraction of the walk's acceleration that braking uses. The rest is for turning: beside a wall, the velocity of a
// visitor who turns has to change by up to turn rate times speed (0.7 m/s²) to continue along the wall.
constexpr double kBraking = 0.5;

/// Returns the commanded velocity, in the visitor's axes, without the components that the walls ahead forbid.
Vector2d wanted_velocity(const Walker& walker, const SteeringCommand& command, const WalkLimits& limits, double scale,
                         const WalkableArea& area) {
  const Vector2d desired(command.right * limits.sideways_m_per_s, command.forward * limits.forward_m_per_s);
  // A command to rest is not changed, even between walls that are near to each other.
  if (desired.isZero(0.0)) return desired;
  const Vector2d right = right_of(walker.heading_rad);
  const Vector2d forward = forward_of(walker.heading_rad);
  const auto in_scene = [&](const Vector2d& v) { return Vector2d(v.x() * right + v.y() * forward); };
  const double share = std::min(limits.forward().acceleration, limits.sideways().acceleration);
  const RampLimits braking{kBraking * share, limits.jerk_m_per_s3 * share / limits.acceleration_m_per_s2};
  const Motion motion{in_scene(walker.velocity_m_per_s), in_scene(walker.acceleration_m_per_s2)};
  const Vector2d free = braked(area, walker.position_m, in_scene(desired), motion, braking, scale);
  const Vector2d wanted(free.dot(right), free.dot(forward));
  if (wanted == desired) return wanted;
  // Along a wall the visitor could be led sideways faster than the sideways limit; the velocity is then scaled down.
  const double excess = std::max(std::abs(wanted.x()) / std::max(limits.sideways_m_per_s, kMinSpeed),
                                 std::abs(wanted.y()) / std::max(limits.forward_m_per_s, kMinSpeed));
  return excess > 1.0 ? Vector2d(wanted / excess) : wanted;
}

}  // namespace

SteeringCommand SteeringCommand::limited() const {
  SteeringCommand command{part_of(forward), part_of(right), part_of(turn)};
  const double length = std::hypot(command.forward, command.right);
  if (length > 1.0) {
    command.forward /= length;
    command.right /= length;
  }
  return command;
}

Vector2d forward_of(double heading_rad) { return {std::sin(heading_rad), -std::cos(heading_rad)}; }
Vector2d right_of(double heading_rad) { return {std::cos(heading_rad), std::sin(heading_rad)}; }

Walker walked(const Walker& walker, const SteeringCommand& command, Duration elapsed, const WalkLimits& limits,
              double walking_scale, const WalkableArea* area) {
  const double seconds = to_seconds(std::clamp(elapsed, Duration::zero(), kMaxStep));
  if (seconds == 0.0) return walker;
  const SteeringCommand limited = command.limited();
  Walker next = walker;

  const Ramp turn = ramped({walker.turn_rate_rad_per_s, walker.turn_acceleration_rad_per_s2},
                           limited.turn * limits.turn_rad_per_s, seconds, limits.turning());
  next.turn_rate_rad_per_s = turn.speed;
  next.turn_acceleration_rad_per_s2 = turn.acceleration;
  const double turned = 0.5 * (walker.turn_rate_rad_per_s + turn.speed) * seconds;
  next.heading_rad = walker.heading_rad + turned;
  if (area == nullptr) {
    next.velocity_m_per_s.setZero();
    next.acceleration_m_per_s2.setZero();
    return next;
  }

  const Vector2d wanted = wanted_velocity(walker, limited, limits, walking_scale, *area);
  const Ramp sideways =
      ramped({walker.velocity_m_per_s.x(), walker.acceleration_m_per_s2.x()}, wanted.x(), seconds, limits.sideways());
  const Ramp ahead =
      ramped({walker.velocity_m_per_s.y(), walker.acceleration_m_per_s2.y()}, wanted.y(), seconds, limits.forward());
  next.velocity_m_per_s = {sideways.speed, ahead.speed};
  next.acceleration_m_per_s2 = {sideways.acceleration, ahead.acceleration};
  // Two ramps that began at different times can both be fast; together they are limited to the walk's speed.
  const double fastest = std::max(limits.forward_m_per_s, limits.sideways_m_per_s);
  if (const double speed = next.velocity_m_per_s.norm(); speed > fastest) next.velocity_m_per_s *= fastest / speed;
  const Vector2d mean = 0.5 * (walker.velocity_m_per_s + next.velocity_m_per_s);
  if (mean.isZero(0.0)) return next;

  const double middle_heading = walker.heading_rad + 0.5 * turned;
  const Vector2d right = right_of(middle_heading);
  const Vector2d forward = forward_of(middle_heading);
  // Length of the step in the scene per metre per second of the visitor.
  const double metres = seconds * walking_scale;
  const Vector2d step = metres * (mean.x() * right + mean.y() * forward);
  next.position_m = area->walk(walker.position_m, step);
  const Vector2d walked = next.position_m - walker.position_m;
  // Only an edge changes a step by more than rounding; without an edge the velocity stays exactly as it is.
  if ((walked - step).norm() > 1e-6 * step.norm() + 1e-13 * walker.position_m.norm()) {
    const Vector2d left(walked.dot(right) / metres, walked.dot(forward) / metres);
    const double speed = next.velocity_m_per_s.norm();
    next.velocity_m_per_s = left.norm() > speed ? Vector2d(left * (speed / left.norm())) : left;
    next.acceleration_m_per_s2.setZero();
  }
  return next;
}

}  // namespace cyclorama::tour
