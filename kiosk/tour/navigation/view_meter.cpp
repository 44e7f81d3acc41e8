// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/navigation/view_meter.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cyclorama::tour {
namespace {

void raise(double* peak, double value) { *peak = std::max(*peak, std::abs(value)); }

}  // namespace

void ViewMeter::add(const Eigen::Vector2d& position_m, double heading_rad, TimePoint at) {
  const View view{position_m, heading_rad, at};
  if (!position_m.allFinite() || !std::isfinite(heading_rad)) peaks_.finite = false;
  if (!last_ || !peaks_.finite) {
    last_ = view;
    return;
  }
  const View before = *last_;
  const Eigen::Vector2d moved = (position_m - before.position_m) / scale_;
  const double turned = heading_rad - before.heading_rad;
  if (at <= before.at) {
    // A jump, which took no time.
    if (!moved.isZero(0.0)) peaks_.speed_m_per_s = std::numeric_limits<double>::infinity();
    if (turned != 0.0) peaks_.turn_rad_per_s = std::numeric_limits<double>::infinity();
    return;
  }
  last_ = view;
  const Duration step = at - before.at;
  const double seconds = to_seconds(step);
  const double middle = before.heading_rad + 0.5 * turned;
  const Eigen::Vector3d velocity =
      Eigen::Vector3d(moved.dot(right_of(middle)), moved.dot(forward_of(middle)), turned) / seconds;
  peaks_.distance_m += moved.norm();
  raise(&peaks_.speed_m_per_s, velocity.head<2>().cwiseAbs().maxCoeff());
  raise(&peaks_.turn_rad_per_s, velocity.z());
  const std::optional<Motion> slower = velocity_;
  velocity_ = Motion{velocity, step};
  if (!slower || slower->step != step) {
    acceleration_.reset();
    return;
  }
  const Eigen::Vector3d acceleration = (velocity - slower->value) / seconds;
  raise(&peaks_.acceleration_m_per_s2, acceleration.head<2>().cwiseAbs().maxCoeff());
  raise(&peaks_.turn_acceleration_rad_per_s2, acceleration.z());
  if (acceleration_) {
    const Eigen::Vector3d jerk = (acceleration - acceleration_->value) / seconds;
    raise(&peaks_.jerk_m_per_s3, jerk.head<2>().cwiseAbs().maxCoeff());
    raise(&peaks_.turn_jerk_rad_per_s3, jerk.z());
  }
  acceleration_ = Motion{acceleration, step};
}

}  // namespace cyclorama::tour
