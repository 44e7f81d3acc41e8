// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace cyclorama::display {

/// Up to this distance a frame is shown from the visitor's own eye. Beyond it, an ever smaller share of the distance is
/// compensated, since too much of what comes into view is unknown.
inline constexpr double kFullMove_m = 0.6;
/// From this distance on a frame is shown from its own eye: the visitor has moved elsewhere, such as to another stop of
/// the tour.
inline constexpr double kMaxMove_m = 0.9;

struct EyeMove {
  Eigen::Vector3d eye_m = Eigen::Vector3d::Zero();  ///< Eye frame of the picture: x right, y up, z back.
  double missed_m = 0.0;                            ///< Distance from the moved eye to the visitor's.
};

/// Returns by how much to move the eye of a picture, seen from `picture_eye_m` in the Scene frame with that heading, for
/// a visitor at `eye_now_m`. Zero if either is not finite.
[[nodiscard]] EyeMove eye_move(const Eigen::Vector3d& picture_eye_m, double picture_heading_rad,
                               const Eigen::Vector3d& eye_now_m);

}  // namespace cyclorama::display
