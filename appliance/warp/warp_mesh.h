// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "appliance/warp/projector_map.h"
#include "common/base/result.h"
#include "common/geometry/picture_place.h"

namespace cyclorama::warp {

/// One corner of a mesh cell. Its angles are NaN if its pixel has no position in the picture.
struct WarpVertex {
  float x_px = 0.0f;  ///< Position in the projector's picture, from its left and upper edge.
  float y_px = 0.0f;
  float azimuth_rad = 0.0f;    ///< For pictures of other shapes than a panorama: PicturePlace::across.
  float tan_elevation = 0.0f;  ///< For pictures of other shapes than a panorama: PicturePlace::up.

  [[nodiscard]] bool is_valid() const { return azimuth_rad == azimuth_rad && tan_elevation == tan_elevation; }
};

/// A cell that a crease of the wall crosses. Its triangles end at the crease.
struct CutCell {
  int cell = 0;                        ///< Index of the cell, row by row from the top.
  std::vector<std::uint32_t> corners;  ///< Three indices into the mesh's vertices for each triangle.
};

/// A grid over one projector's whole picture, with each vertex's position in the panorama, between which the graphics
/// card interpolates. Each cell is two triangles, divided from its upper left to its lower right corner, or more
/// triangles where the map has a kink. A value; reentrant.
struct WarpMesh {
  int width_px = 0;
  int height_px = 0;
  int cells_x = 0;
  int cells_y = 0;
  /// (cells_x + 1) * (cells_y + 1) vertices, row by row from the top; then additional vertices of cut cells.
  std::vector<WarpVertex> vertices;
  double worst_error_px = 0.0;     ///< Maximum deviation from the exact map, on the wall, in panorama pixels.
  std::vector<CutCell> cuts = {};  ///< Sorted by ascending cell.

  /// Returns three indices per triangle. Triangles with an invalid corner are omitted: nothing is drawn there.
  [[nodiscard]] std::vector<std::uint32_t> triangles() const;
  /// Returns the graphics card's interpolation at a position inside the picture; empty in an omitted triangle.
  [[nodiscard]] std::optional<PanoramaDirection> interpolate(const Eigen::Vector2d& pixel) const;
};

/// Returns a mesh of few cells that deviates by at most `tolerance_px` of `picture`'s pixels wherever the projector
/// meets the wall. Cells are halved in the direction that gains more, and cut along the wall's creases. Errors:
/// kInvalidArgument if even the finest cells deviate by more, or if more than `max_cells` would be needed: the
/// projector is too near the wall or grazes it, or a free-form wall has too many corners.
Result<WarpMesh> make_warp_mesh(const ProjectorMap& map, const PictureShape& picture, double tolerance_px = 0.05,
                                int max_cells = std::numeric_limits<int>::max());

}  // namespace cyclorama::warp
