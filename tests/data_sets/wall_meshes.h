// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>

#include "common/room/cylinder_wall.h"

namespace cyclorama {

/// The same wall as an OBJ file of quadrangles.
inline std::string obj_of(const CylinderWall& wall, int columns, int rows) {
  std::string text = "# A wall.\n";
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const double height = wall.bottom_m + (wall.top_m - wall.bottom_m) * j / rows;
      const Eigen::Vector3d p = wall.point_at(wall.arc_rad * (static_cast<double>(i) / columns - 0.5), height).xyz;
      text += fmt::format("v {} {} {}\nvt {} {}\n", p.x(), p.y(), p.z(), static_cast<double>(i) / columns,
                          static_cast<double>(j) / rows);
    }
  }
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const int a = j * (columns + 1) + i + 1;
      const int c = a + columns + 1;
      text += fmt::format("f {0}/{0} {1}/{1} {2}/{2} {3}/{3}\n", a, a + 1, c + 1, c);
    }
  }
  return text;
}

}  // namespace cyclorama
