// SPDX-License-Identifier: Apache-2.0
/// Small changes of a pose, as parametrised by the filter and the solver.
///
///   step = (rotation, translation), both in the body's own frame:   T' = T * [exp(rotation), translation]
///
/// A chart of SE(3) about T: exact both ways for rotations below half a turn. Reentrant.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/geometry/rigid_transform.h"

namespace cyclorama::calibration {

/// A small change of a pose: rotation in radians, then translation in metres.
using PoseStep = Eigen::Matrix<double, 6, 1>;
using PoseMatrix = Eigen::Matrix<double, 6, 6>;

/// Maximum displacement that counts as a bump. After a larger one, a new calibration is needed.
inline constexpr double kMaxTurn_rad = 0.12;
inline constexpr double kMaxShift_m = 0.15;

[[nodiscard]] inline Eigen::Quaterniond turned_by(const Eigen::Vector3d& turn) {
  const double angle = turn.norm();
  if (!(angle > 1e-300)) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle));
}

template <typename To, typename Body>
[[nodiscard]] RigidTransform<To, Body> stepped(const RigidTransform<To, Body>& T, const PoseStep& step) {
  return T * RigidTransform<Body, Body>(turned_by(step.head<3>()), step.tail<3>());
}

/// Returns the step with which stepped(from, step) equals `to`.
template <typename To, typename Body>
[[nodiscard]] PoseStep step_between(const RigidTransform<To, Body>& from, const RigidTransform<To, Body>& to) {
  const RigidTransform<Body, Body> change = from.inverse() * to;
  const Eigen::AngleAxisd turn(change.rotation());
  PoseStep step;
  step.head<3>() = turn.angle() * turn.axis();
  step.tail<3>() = change.translation();
  return step;
}

/// Interpolates between two poses, with `part` in [0, 1], so that a display can move from one to the other without a
/// jump.
template <typename To, typename Body>
[[nodiscard]] RigidTransform<To, Body> between(const RigidTransform<To, Body>& from, const RigidTransform<To, Body>& to,
                                               double part) {
  return stepped(from, part * step_between(from, to));
}

}  // namespace cyclorama::calibration
