// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace cyclorama::display {

/// Distance of the visitor's eye from the picture's eye up to which the move is compensated completely. Beyond it, an
/// ever smaller share is compensated, since too much of what comes into view is unknown.
inline constexpr double kFullMove_m = 0.6;
/// Distance from which on no move is compensated: the visitor has moved elsewhere, for example to another stop of the
/// tour.
inline constexpr double kMaxMove_m = 0.9;

struct EyeMove {
  Eigen::Vector3d eye_m = Eigen::Vector3d::Zero();  ///< Move in the picture's Eye frame: x right, y up, z back.
  double missed_m = 0.0;                            ///< Distance from the moved eye to the visitor's.
};

/// Returns the move of a picture's eye towards the visitor's eye at `eye_now_m`. The picture was seen from
/// `picture_eye_m` with heading `picture_heading_rad`; both positions are in the Scene frame. Zero if either is not
/// finite.
[[nodiscard]] EyeMove eye_move(const Eigen::Vector3d& picture_eye_m, double picture_heading_rad,
                               const Eigen::Vector3d& eye_now_m);

}  // namespace cyclorama::display
