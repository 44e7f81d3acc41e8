// SPDX-License-Identifier: Apache-2.0
/// Finds the triangles that visitors can see, and their smallest distance.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "renderfarm/light_baking/bake_settings.h"
#include "renderfarm/render/renderer.h"
#include "renderfarm/render/vectors.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::light_baking {

/// The nearest eye's observation of a triangle: its distance, and the point that it sees.
struct SeenPlace {
  float distance = std::numeric_limits<float>::infinity();  ///< In metres; infinite if no eye sees the triangle.
  std::uint16_t u = 0;                                      ///< Barycentric weights of corners 1 and 2, times 65535.
  std::uint16_t v = 0;

  [[nodiscard]] bool is_seen() const { return std::isfinite(distance); }
  [[nodiscard]] render::Vec3 weights() const;
};

/// Observations of each triangle, by placement and side; empty if no triangle of that side is seen.
struct VisibleTriangles {
  std::vector<std::array<std::vector<SeenPlace>, 2>> places;
  std::uint64_t seen = 0;  ///< Number of seen triangles, each side counted separately.
  double cpu_seconds = 0.0;
};

/// Returns eye positions in the Scene frame, evenly distributed over the walkable area and around the height of the
/// start eye.
[[nodiscard]] std::vector<Eigen::Vector3d> walkable_eyes(const scene::SceneInfo& info, int count, std::uint64_t seed);

/// Traces rays in all directions from walkable_eyes(). Does not find triangles that are visible only through glass or
/// in a mirror. `cancelled` may be null.
[[nodiscard]] VisibleTriangles find_visible_triangles(const render::Renderer& renderer, const BakeSettings& settings,
                                                      const std::function<bool()>& cancelled);

}  // namespace cyclorama::light_baking
