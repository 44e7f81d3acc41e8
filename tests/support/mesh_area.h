// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "appliance/warp/warp_mesh.h"

namespace cyclorama {

/// Returns the total area of all drawn triangles in square pixels. It equals the area of the picture if they cover it
/// exactly once.
inline double area_px2(const warp::WarpMesh& mesh) {
  double area = 0.0;
  const std::vector<std::uint32_t> corners = mesh.triangles();
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    const warp::WarpVertex& a = mesh.vertices[corners[i]];
    const warp::WarpVertex& b = mesh.vertices[corners[i + 1]];
    const warp::WarpVertex& c = mesh.vertices[corners[i + 2]];
    area += 0.5 * std::abs((b.x_px - a.x_px) * (c.y_px - a.y_px) - (c.x_px - a.x_px) * (b.y_px - a.y_px));
  }
  return area;
}

}  // namespace cyclorama
