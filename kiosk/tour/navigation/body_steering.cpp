// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/navigation/body_steering.h"

#include <cmath>

namespace cyclorama::tour {

double lean_of(const RigidTransform<frame::Camera, frame::Tag>& T_camera_body) {
  // The body's upward direction; the camera's y points down.
  const Eigen::Vector3d up = T_camera_body.rotation() * Eigen::Vector3d(0.0, -1.0, 0.0);
  constexpr double kLying = 0.26;
  return std::hypot(up.x(), up.y()) > kLying ? std::atan2(-up.x(), -up.y()) : 0.0;
}

SteeringCommand body_command(const RigidTransform<frame::Camera, frame::Tag>& T_camera_body,
                             const BodySteeringSettings& settings) {
  const Eigen::Vector3d& position = T_camera_body.translation();
  const SteeringCommand command{settings.distance_m.at(settings.mark_distance_m - position.z()),
                                settings.sideways_m.at(-position.x() - settings.neutral_right_m),
                                settings.lean_rad.at(lean_of(T_camera_body))};
  return command.limited();
}

}  // namespace cyclorama::tour
