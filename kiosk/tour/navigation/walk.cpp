// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/navigation/walk.h"

#include <algorithm>
#include <cmath>

namespace cyclorama {
namespace {

using Eigen::Vector2d;

double part_of(double value) { return std::isnan(value) ? 0.0 : std::clamp(value, -1.0, 1.0); }

Vector2d towards(const Vector2d& from, const Vector2d& to, double most) {
  const Vector2d change = to - from;
  const double length = change.norm();
  return length <= most ? to : Vector2d(from + change * (most / length));
}

double towards(double from, double to, double most) { return from + std::clamp(to - from, -most, most); }

}  // namespace

SteeringWish SteeringWish::limited() const {
  SteeringWish wish{part_of(forward), part_of(right), part_of(turn)};
  const double length = std::hypot(wish.forward, wish.right);
  if (length > 1.0) {
    wish.forward /= length;
    wish.right /= length;
  }
  return wish;
}

Vector2d forward_of(double heading_rad) { return {std::sin(heading_rad), -std::cos(heading_rad)}; }
Vector2d right_of(double heading_rad) { return {std::cos(heading_rad), std::sin(heading_rad)}; }

Walker walked(const Walker& walker, const SteeringWish& wish, Duration elapsed, const WalkLimits& limits,
              double walking_scale, const WalkableArea* area) {
  const double seconds = to_seconds(std::clamp(elapsed, Duration::zero(), kLongestStep));
  if (seconds == 0.0) return walker;
  const SteeringWish limited = wish.limited();
  Walker next = walker;

  next.turn_rate_rad_per_s = towards(walker.turn_rate_rad_per_s, limited.turn * limits.turn_rad_per_s,
                                     limits.turn_acceleration_rad_per_s2 * seconds);
  const double turned = 0.5 * (walker.turn_rate_rad_per_s + next.turn_rate_rad_per_s) * seconds;
  next.heading_rad = walker.heading_rad + turned;

  const Vector2d wanted(limited.right * limits.sideways_m_per_s, limited.forward * limits.forward_m_per_s);
  next.velocity_m_per_s = area == nullptr
                              ? Vector2d::Zero().eval()
                              : towards(walker.velocity_m_per_s, wanted, limits.acceleration_m_per_s2 * seconds);
  if (next.velocity_m_per_s.isZero(0.0)) return next;

  const double middle_heading = walker.heading_rad + 0.5 * turned;
  const Vector2d right = right_of(middle_heading);
  const Vector2d forward = forward_of(middle_heading);
  const double metres = seconds * walking_scale;  // In the scene, per metre per second of the visitor.
  const Vector2d step = metres * (next.velocity_m_per_s.x() * right + next.velocity_m_per_s.y() * forward);
  next.place_m = area->walk(walker.place_m, step);
  const Vector2d walked = next.place_m - walker.place_m;
  // Only an edge changes a step by more than rounding; without one the velocity stays exactly as it is.
  if ((walked - step).norm() > 1e-6 * step.norm() + 1e-13 * walker.place_m.norm()) {
    const Vector2d left(walked.dot(right) / metres, walked.dot(forward) / metres);
    const double speed = next.velocity_m_per_s.norm();
    next.velocity_m_per_s = left.norm() > speed ? Vector2d(left * (speed / left.norm())) : left;
  }
  return next;
}

}  // namespace cyclorama
