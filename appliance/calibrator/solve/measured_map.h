// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "appliance/warp/pixel_map.h"
#include "common/base/result.h"
#include "common/geometry/projection.h"

namespace cyclorama {

/// That a projector's pixel is seen in a direction; the pixel has noise, the direction has none.
struct MapSample {
  Eigen::Vector2d projector_px;
  Eigen::Vector3d direction;  ///< Eye frame, unit length.
  double sigma_px = 0.1;      ///< In projector pixels, each way.
};

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

struct MapOptions {
  int cell_px = 16;            ///< Of the control grid, about.
  double most_sigma_px = 2.0;  ///< Past that a gap is not filled,
  double most_gap_px = 240.0;  ///< nor farther than that from what was seen: smoothness is a guess there.
  std::size_t least_samples = 60;
  int left_out_every = 8;  ///< One block of samples in so many is held out while the stiffness is chosen.
};

/// Robust least squares with smoothness, by sparse Cholesky; control points' variances by selected inversion. Creases
/// are allowed for: a bend counts less the sharper it is.
/// kInvalidArgument  too few samples, all on a line, or all round the sweet spot: says what to add.
/// kBadData  the least-squares problem has no solution. Reentrant.
Result<MeasuredMap> fit_measured_map(int width_px, int height_px, std::span<const MapSample> samples,
                                     const MapOptions& options = {});

/// Of the samples, where the map has a direction: 0 to 1.
[[nodiscard]] double known_part(const MeasuredMap& map, std::span<const MapSample> samples);

/// Of samples, in projector pixels per axis, without the worst twentieth; nothing where the map has no direction for
/// most of them.
[[nodiscard]] std::optional<double> map_error_px(const MeasuredMap& map, std::span<const MapSample> samples);

/// What a display draws with. kBadData  no control point has a place in the picture.
Result<Warp> warp_of(const MeasuredMap& map, const PictureShape& picture);

}  // namespace cyclorama
