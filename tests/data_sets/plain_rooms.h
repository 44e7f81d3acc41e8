// SPDX-License-Identifier: Apache-2.0
/// Rooms whose walkable area can be determined by hand: boxes and slabs.
#pragma once

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <numbers>
#include <utility>

#include "tests/data_sets/simple_scenes.h"

namespace cyclorama {

/// A box with all six sides, between two corners.
inline scene::Mesh box_mesh(const Eigen::Vector3f& min, const Eigen::Vector3f& max) {
  scene::Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.positions.push_back(
        {(i & 1) != 0 ? max.x() : min.x(), (i & 2) != 0 ? max.y() : min.y(), (i & 4) != 0 ? max.z() : min.z()});
  }
  const auto side = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  side(0, 1, 3, 2);
  side(4, 6, 7, 5);
  side(0, 4, 5, 1);
  side(2, 3, 7, 6);
  side(0, 2, 6, 4);
  side(1, 5, 7, 3);
  return mesh;
}

/// A quadrangle whose triangles are all visible from both sides.
inline scene::Mesh quad_mesh(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c,
                             const Eigen::Vector3f& d) {
  scene::Mesh mesh;
  for (const Eigen::Vector3f& p : {a, b, c, d}) mesh.positions.push_back({p.x(), p.y(), p.z()});
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// A floor at height 0 from (-half, -half) to (half, half), four walls and a ceiling at 3 m. The visitor starts at
/// (0, 1.6, 0).
inline scene::Scene plain_room(float half) {
  scene::Scene scene = scene_of(box_mesh({-half, 0, -half}, {half, 3, half}));
  scene.info.start_eye = {0, 1.6, 0};
  scene.info.eye_height_m = 1.6;
  return scene;
}

inline void add_box(scene::Scene& scene, const Eigen::Vector3f& min, const Eigen::Vector3f& max) {
  add_mesh(scene, box_mesh(min, max));
}

}  // namespace cyclorama
