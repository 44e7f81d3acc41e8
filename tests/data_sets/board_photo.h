// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "appliance/calibration/brown_lens.h"
#include "common/board/tag_board.h"
#include "common/geometry/frames.h"
#include "common/geometry/rigid_transform.h"
#include "common/image/image.h"

namespace cyclorama {

/// Renders photographs of a board on a grey table, through a lens with distortion: each pixel is the mean of 3 x 3
/// rays, without noise. A value.
class BoardPhotographer {
 public:
  /// Precondition: the lens has a ray for every pixel.
  BoardPhotographer(const TagBoard& board, const calibration::BrownLens& lens);

  /// `R` and `t` transform a point of the board (its origin is the first corner) to the camera's frame.
  [[nodiscard]] GreyImage photograph(const Eigen::Matrix3d& R, const Eigen::Vector3d& t) const;

 private:
  [[nodiscard]] double grey_at(const Eigen::Vector2d& board_m) const;

  TagBoard board_;
  int width_px_;
  int height_px_;
  std::vector<Eigen::Vector2d> slopes_;   ///< Slopes of all rays, computed once.
  std::vector<std::vector<bool>> white_;  ///< Colours of each tag's cells.
  int cells_ = 0;
  double width_in_tags_ = 0.0;
};

}  // namespace cyclorama
