// SPDX-License-Identifier: Apache-2.0
/// Movement of a tag in a visitor's hand in front of a camera: a pure function of time, for simulated cameras and their
/// tests.
///
///   The visitor faces the camera. Camera frame: x right, y down, z forward; so the visitor's right is -x, and
///   yaw    turns about the camera's y: positive when the visitor turns to their right (clockwise seen from above),
///   pitch  turns about the camera's x: positive when the upper edge of the tag leans away from the camera,
///   roll   turns about the camera's z: positive when the tag turns clockwise as the camera sees it.
///   R_camera_tag = R_y(yaw) R_x(-pitch) R_z(roll); if all are 0, the tag is upright and faces the camera.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/rigid_transform.h"

namespace cyclorama::simulated {

/// Pose of the tag at one time.
struct KeyPose {
  double time_s = 0.0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< Centre of the tag in the Camera frame.
  double yaw_rad = 0.0;
  double pitch_rad = 0.0;
  double roll_rad = 0.0;
};

/// A smooth movement through key poses. It passes through every key and, between two keys, stays within the range of
/// their values, so a hand that is held still stays still. The pieces are cubic Hermite polynomials with the slopes of
/// Fritsch and Butland, "A Method for Constructing Local Monotone Piecewise Cubic Interpolants", SIAM J. Sci. Stat.
/// Comput. 5 (1984). Immutable; reentrant.
class HandPath {
 public:
  /// `loop_s` is the time at which the movement returns to the first key and starts again; without it the last pose is
  /// held. Errors: kInvalidArgument if there is no key, a number is not finite, the times do not increase, or the loop
  /// ends before the last key.
  static Result<HandPath> make(std::vector<KeyPose> keys, std::optional<double> loop_s);
  /// Movement of the demo, 28 s: stand, walk on, turn right, walk on, turn left, step to the right, step back.
  static HandPath demo();

  /// Accepts any time, also before the first key; a time that is not finite yields the first key's pose.
  [[nodiscard]] RigidTransform<frame::Camera, frame::Tag> at(double time_s) const;
  /// Time from the first key to the end of the loop, or to the last key.
  [[nodiscard]] double duration_s() const { return keys_.back().time_s - keys_.front().time_s; }

 private:
  using Values = Eigen::Matrix<double, 6, 1>;  ///< x, y, z, yaw, pitch, roll.
  HandPath(std::vector<KeyPose> keys, bool loops) : keys_(std::move(keys)), loops_(loops) {}
  [[nodiscard]] static Values values_of(const KeyPose& key);
  [[nodiscard]] Values slope_of(std::size_t piece) const;
  [[nodiscard]] Values slope_at(std::size_t key) const;

  std::vector<KeyPose> keys_;  ///< A looping path ends with a copy of its first key.
  bool loops_;
};

/// Returns the rotation for the three angles.
[[nodiscard]] Eigen::Quaterniond rotation_of(const KeyPose& key);

}  // namespace cyclorama::simulated
