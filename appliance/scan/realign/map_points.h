// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "appliance/calibration/measured_map.h"

namespace cyclorama::scan {

/// Calls `body`(projector pixel, direction) for each control point of a map that has a direction, row by row.
template <typename Body>
void for_points(const calibration::MeasuredMap& map, const Body& body) {
  std::size_t point = 0;
  for (int y = 0; y <= map.cells_y; ++y) {
    for (int x = 0; x <= map.cells_x; ++x) {
      const Eigen::Vector3d& direction = map.directions[point++];
      const Eigen::Vector2d pixel(x * static_cast<double>(map.width_px) / map.cells_x,
                                  y * static_cast<double>(map.height_px) / map.cells_y);
      if (direction.allFinite()) body(pixel, direction);
    }
  }
}

}  // namespace cyclorama::scan
