// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "appliance/warp/projector_map.h"
#include "common/base/result.h"
#include "common/geometry/panorama.h"

namespace cyclorama {

/// One corner of a mesh cell. A corner whose pixel has no direction has NaNs there.
struct WarpVertex {
  float x_px = 0.0f;  ///< In the projector's picture, from its left and upper edge.
  float y_px = 0.0f;
  float azimuth_rad = 0.0f;
  float tan_elevation = 0.0f;

  [[nodiscard]] bool is_valid() const { return azimuth_rad == azimuth_rad && tan_elevation == tan_elevation; }
};

/// A grid over one projector's whole picture that tells where in the panorama each pixel lies: what a graphics card
/// interpolates. Each cell is two triangles, cut from its upper left to its lower right corner. A value; reentrant.
struct WarpMesh {
  int width_px = 0;
  int height_px = 0;
  int cells_x = 0;
  int cells_y = 0;
  std::vector<WarpVertex> vertices;  ///< (cells_x + 1) * (cells_y + 1), row by row from the top.
  double worst_error_px = 0.0;       ///< Against the exact map, in panorama pixels, on the wall.

  /// Three per triangle. Triangles with an invalid corner are left out: nothing is drawn there.
  [[nodiscard]] std::vector<std::uint32_t> triangles() const;
  /// What the graphics card interpolates at a place inside the picture; nothing in a triangle that is left out.
  [[nodiscard]] std::optional<PanoramaDirection> interpolate(const Eigen::Vector2d& pixel) const;
};

/// A mesh of few cells, halved along whichever direction gains more, that keeps to `tolerance_px` of
/// `picture`'s pixels wherever the projector meets the wall. kInvalidArgument  even cells of one pixel do not: the
/// projector is too near the wall or grazes it.
Result<WarpMesh> make_warp_mesh(const ProjectorMap& map, const Panorama& picture, double tolerance_px = 0.05);

}  // namespace cyclorama
