// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "appliance/warp/pixel_map.h"
#include "common/base/result.h"
#include "common/geometry/projection.h"

namespace cyclorama::calibration {

/// A projector's map from pixels to directions from the sweet spot, without a model of the wall: a grid of control
/// points over the whole picture, interpolated linearly in the same triangles as a WarpMesh (each cell is divided from
/// its upper left to its lower right corner). A value; reentrant.
struct MeasuredMap {
  int width_px = 0;
  int height_px = 0;
  int cells_x = 0;
  int cells_y = 0;
  /// (cells_x + 1) * (cells_y + 1) unit vectors in the Eye frame, row by row from the top; NaN where no data is nearby.
  std::vector<Eigen::Vector3d> directions;
  /// One for each direction, in projector pixels per axis; large in gaps and beyond the rim of the data.
  std::vector<double> sigma_px;
  double heldout_rms_px = 0.0;  ///< Root mean square error per axis, over cells that were left out of the fit.
  /// Change of slope per cell that the smoothness term expects; chosen with left-out cells.
  double stiffness_px = 0.0;
  std::size_t samples = 0;

  /// Returns a unit vector; empty outside the picture or where the map has no direction.
  [[nodiscard]] std::optional<Eigen::Vector3d> direction_at(const Eigen::Vector2d& pixel) const;
  /// Returns the interpolated sigma; infinite where direction_at() is empty.
  [[nodiscard]] double sigma_at(const Eigen::Vector2d& pixel) const;
};

/// Converts a map to the warp that a display uses. Errors: kBadData if no control point has a position in the picture.
Result<warp::Warp> warp_of(const MeasuredMap& map, const PictureShape& picture);

}  // namespace cyclorama::calibration
