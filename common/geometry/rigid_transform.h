// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "common/geometry/frames.h"

namespace cyclorama {

/// A point in metres, expressed in frame F.
template <typename F>
struct Point {
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();
};

/// A rigid transform, named T_to_from: it maps coordinates in `From` to coordinates in `To`.
///
///   p_world = T_world_camera * p_camera
///   T_world_tag = T_world_camera * T_camera_tag     (inner names must match; the compiler checks)
///
/// The columns of rotation() are From's axes in To; translation() is From's origin in To.
template <typename To, typename From>
class RigidTransform {
 public:
  RigidTransform() = default;
  RigidTransform(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation)
      : rotation_(rotation.normalized()), translation_(translation) {}

  [[nodiscard]] Point<To> operator*(const Point<From>& p) const {
    return {rotation_ * p.xyz + translation_};
  }
  template <typename Inner>
  [[nodiscard]] RigidTransform<To, Inner> operator*(const RigidTransform<From, Inner>& other) const {
    return {rotation_ * other.rotation(), rotation_ * other.translation() + translation_};
  }
  [[nodiscard]] RigidTransform<From, To> inverse() const {
    const Eigen::Quaterniond r = rotation_.conjugate();
    return {r, -(r * translation_)};
  }
  [[nodiscard]] const Eigen::Quaterniond& rotation() const { return rotation_; }
  [[nodiscard]] const Eigen::Vector3d& translation() const { return translation_; }

 private:
  Eigen::Quaterniond rotation_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation_ = Eigen::Vector3d::Zero();
};

}  // namespace cyclorama
