// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/interchange/pose_report.h"

#include <cmath>

namespace cyclorama::tracker {

std::optional<RigidTransform<frame::Camera, frame::Tag>> pose_of(const PoseReport& report, TrackerAxes axes) {
  const Eigen::Vector3d position(report.position_m[0], report.position_m[1], report.position_m[2]);
  const Eigen::Quaterniond rotation(report.rotation[0], report.rotation[1], report.rotation[2], report.rotation[3]);
  constexpr double kFarM = 1e6;
  // Other programs send rounded single-precision numbers: a deviation of a hundredth from a unit quaternion is
  // accepted.
  const bool is_pose = position.allFinite() && position.norm() < kFarM && std::abs(rotation.norm() - 1.0) < 0.01;
  if (!report.found || !is_pose) return std::nullopt;
  if (axes == TrackerAxes::kCamera) return RigidTransform<frame::Camera, frame::Tag>(rotation, position);
  // Half a turn about Z takes the room's axes to the camera's: X and Y change their signs, in rotations and in
  // positions.
  const Eigen::Quaterniond turned(rotation.w(), -rotation.x(), -rotation.y(), rotation.z());
  return RigidTransform<frame::Camera, frame::Tag>(turned, {-position.x(), -position.y(), position.z()});
}

}  // namespace cyclorama::tracker
