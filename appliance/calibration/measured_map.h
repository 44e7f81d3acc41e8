// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "appliance/warp/pixel_map.h"
#include "common/base/result.h"
#include "common/geometry/projection.h"

namespace cyclorama::calibration {

/// From a projector's pixels to directions from the sweet spot, with no model of the wall: a grid of control points
/// over its whole picture, linear in triangles, which are a WarpMesh's (cut from a cell's upper left to its lower
/// right). A value; reentrant.
struct MeasuredMap {
  int width_px = 0;
  int height_px = 0;
  int cells_x = 0;
  int cells_y = 0;
  /// (cells_x + 1) * (cells_y + 1) unit vectors, Eye frame, row by row from the top; NaN where nothing near was seen.
  std::vector<Eigen::Vector3d> directions;
  std::vector<double> sigma_px;  ///< Of each, in projector pixels, each way; large in gaps and past the rim.
  double heldout_rms_px = 0.0;   ///< Per axis, of cells that the fit did not see.
  double stiffness_px = 0.0;  ///< The change of slope per cell that the smoothness expects; chosen by held-out cells.
  std::size_t samples = 0;

  /// A unit vector; nothing outside of the picture and where the map has none.
  [[nodiscard]] std::optional<Eigen::Vector3d> direction_at(const Eigen::Vector2d& pixel) const;
  /// Infinite where direction_at() has nothing.
  [[nodiscard]] double sigma_at(const Eigen::Vector2d& pixel) const;
};

/// What a display draws with. kBadData  no control point has a place in the picture.
Result<warp::Warp> warp_of(const MeasuredMap& map, const PictureShape& picture);

}  // namespace cyclorama::calibration
