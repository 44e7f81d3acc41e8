// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/polygon.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace cyclorama {
namespace {

using Corners = std::vector<Eigen::Vector3d>;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Triangles triangles_of(const Corners& corners) {
  Triangles triangles;
  triangulate(corners, &triangles);
  return triangles;
}

/// Sum of the triangles' area vectors; equals the polygon's own if they cover it once with its winding.
Eigen::Vector3d area(const Corners& corners, const Triangles& triangles) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& t : triangles) {
    sum += 0.5 * (corners[t[1]] - corners[t[0]]).cross(corners[t[2]] - corners[t[0]]);
  }
  return sum;
}

double total_area(const Corners& corners, const Triangles& triangles) {
  double sum = 0.0;
  for (const auto& t : triangles)
    sum += 0.5 * (corners[t[1]] - corners[t[0]]).cross(corners[t[2]] - corners[t[0]]).norm();
  return sum;
}

/// A star with `points` points, concave at every other corner, in a tilted plane.
Corners star(int points, bool clockwise) {
  const Eigen::AngleAxisd tilt(1.1, Eigen::Vector3d(1, 2, 3).normalized());
  Corners corners;
  for (int i = 0; i < 2 * points; ++i) {
    const double angle = (clockwise ? -1.0 : 1.0) * std::numbers::pi * i / points;
    const double r = i % 2 == 0 ? 1.0 : 0.3;
    corners.emplace_back(tilt * Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), 0.0) +
                         Eigen::Vector3d(1e4, -5, 7));
  }
  return corners;
}

TEST(Triangulate, gives_two_fewer_triangles_than_corners) {
  EXPECT_TRUE(triangles_of({}).empty());
  EXPECT_TRUE(triangles_of({{0, 0, 0}, {1, 0, 0}}).empty());
  EXPECT_EQ(triangles_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), (Triangles{{0, 1, 2}}));
  EXPECT_EQ(triangles_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}).size(), 2u);
}

TEST(Triangulate, covers_concave_polygons_exactly_once_with_their_winding) {
  for (const int points : {3, 5, 17, 100}) {
    for (const bool clockwise : {false, true}) {
      const Corners corners = star(points, clockwise);
      const Triangles triangles = triangles_of(corners);
      EXPECT_EQ(triangles.size(), corners.size() - 2);
      const Eigen::Vector3d fan = [&] {
        Triangles all;
        for (std::uint32_t i = 2; i < corners.size(); ++i) all.push_back({0, i - 1, i});
        return area(corners, all);
      }();
      EXPECT_LT((area(corners, triangles) - fan).norm(), 1e-6);
      EXPECT_NEAR(total_area(corners, triangles), fan.norm(), 1e-6) << "a triangle lies outside";
    }
  }
}

TEST(Triangulate, keeps_the_triangles_of_an_arrow_inside) {
  const Corners arrow = {{0, 0, 0}, {2, -1, 0}, {0.5, 0, 0}, {2, 1, 0}};
  EXPECT_NEAR(total_area(arrow, triangles_of(arrow)), 0.5, 1e-12);
}

TEST(Triangulate, returns_something_for_polygons_without_a_triangulation) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(triangles_of({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0.5, 0}}).size(), 3u);  // Crosses itself.
  EXPECT_EQ(triangles_of(Corners(9, Eigen::Vector3d::Zero())).size(), 7u);
  EXPECT_EQ(triangles_of(Corners(9, Eigen::Vector3d(nan, 0, 0))).size(), 7u);
  EXPECT_EQ(triangles_of(star(5000, false)).size(), 9998u);
}

}  // namespace
}  // namespace cyclorama
