// SPDX-License-Identifier: Apache-2.0
/// Which triangles visitors can see, and from what distance.
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

/// The nearest sight of a triangle: the distance, and the point that was seen.
struct SeenPlace {
  float distance = std::numeric_limits<float>::infinity();  ///< In metres; infinite if it is not seen.
  std::uint16_t u = 0;                                      ///< Weights of the corners 1 and 2, times 65535.
  std::uint16_t v = 0;

  [[nodiscard]] bool is_seen() const { return std::isfinite(distance); }
  [[nodiscard]] render::Vec3 weights() const;
};

/// For each placement and side, the place of each triangle; empty if no triangle of that side is seen.
struct VisibleTriangles {
  std::vector<std::array<std::vector<SeenPlace>, 2>> places;
  std::uint64_t seen = 0;  ///< Triangles that are seen, each side counted.
  double cpu_seconds = 0.0;
};

/// Returns eye positions in the Scene frame, evenly distributed over the walkable area, at heights around the eye's.
[[nodiscard]] std::vector<Eigen::Vector3d> walkable_eyes(const scene::SceneInfo& info, int count, std::uint64_t seed);

/// Looks in all directions from walkable_eyes(). Triangles that are only visible through glass or in a mirror are not
/// found. `cancelled` may be null.
[[nodiscard]] VisibleTriangles find_visible_triangles(const render::Renderer& renderer, const BakeSettings& settings,
                                                      const std::function<bool()>& cancelled);

}  // namespace cyclorama::light_baking
