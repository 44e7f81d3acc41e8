// SPDX-License-Identifier: Apache-2.0
/// Polygons on the ground, given by their (x, z) corners; the last corner connects to the first.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

namespace cyclorama::scene {

/// Returns the area of the polygon by the shoelace formula; never negative. Parts that overlap with opposite
/// orientation cancel.
[[nodiscard]] inline double area_of(const std::vector<Eigen::Vector2d>& corners) {
  double twice = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d& a = corners[i];
    const Eigen::Vector2d& b = corners[(i + 1) % corners.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * std::abs(twice);
}

/// Returns true if `place` is inside the polygon by the even-odd rule.
[[nodiscard]] inline bool is_inside(const std::vector<Eigen::Vector2d>& corners, const Eigen::Vector2d& place) {
  bool inside = false;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d& a = corners[i];
    const Eigen::Vector2d& b = corners[(i + 1) % corners.size()];
    if ((a.y() > place.y()) == (b.y() > place.y())) continue;
    const double crossing = a.x() + (place.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    if (place.x() < crossing) inside = !inside;
  }
  return inside;
}

}  // namespace cyclorama::scene
