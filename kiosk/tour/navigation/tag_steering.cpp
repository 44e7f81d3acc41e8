// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/navigation/tag_steering.h"

#include <algorithm>
#include <cmath>

namespace cyclorama::tour {

double GainCurve::at(double offset) const {
  if (std::isnan(offset)) return 0.0;
  const double u = std::clamp((std::abs(offset) - dead) / (full - dead), 0.0, 1.0);
  return std::copysign(u * u * (3.0 - 2.0 * u), offset);
}

double pointing_yaw(const RigidTransform<frame::Camera, frame::Tag>& T_camera_tag) {
  const Eigen::Vector3d z = T_camera_tag.rotation() * Eigen::Vector3d::UnitZ();
  // Within 15 degrees of lying flat, the direction is mostly noise.
  constexpr double kFlat = 0.26;
  return std::hypot(z.x(), z.z()) > kFlat ? std::atan2(z.x(), z.z()) : 0.0;
}

SteeringCommand tag_command(const RigidTransform<frame::Camera, frame::Tag>& T_camera_tag,
                            const TagSteeringSettings& settings) {
  const Eigen::Vector3d& position = T_camera_tag.translation();
  const SteeringCommand command{settings.distance_m.at(settings.neutral_distance_m - position.z()),
                                settings.sideways_m.at(-position.x() - settings.neutral_right_m),
                                settings.yaw_rad.at(pointing_yaw(T_camera_tag))};
  return command.limited();
}

}  // namespace cyclorama::tour
