// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/eye_move.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace cyclorama::display {
namespace {
/// Distance below which a move counts as none, far less than the shift of a pixel, so that rounding does not soften a
/// picture at rest.
constexpr double kNothing_m = 1e-6;
}  // namespace

EyeMove eye_move(const Eigen::Vector3d& picture_eye_m, double picture_heading_rad, const Eigen::Vector3d& eye_now_m) {
  const Eigen::Vector3d moved = eye_now_m - picture_eye_m;
  if (!moved.allFinite() || moved.norm() < kNothing_m) return {};
  const double distance = moved.norm();
  const double share = std::clamp((kMaxMove_m - distance) / (kMaxMove_m - kFullMove_m), 0.0, 1.0);
  // A heading is positive to the right, a rotation about y to the left.
  const Eigen::AngleAxisd R_eye_scene(picture_heading_rad, Eigen::Vector3d::UnitY());
  return {share * (R_eye_scene * moved), (1.0 - share) * distance};
}

}  // namespace cyclorama::display
