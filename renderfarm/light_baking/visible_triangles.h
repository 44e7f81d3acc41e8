// SPDX-License-Identifier: Apache-2.0
/// Which triangles visitors can see, and from what distance.
#pragma once

#include <Eigen/Core>
#include <array>
#include <atomic>
#include <functional>
#include <limits>
#include <vector>

#include "renderfarm/light_baking/bake_settings.h"
#include "renderfarm/render/renderer.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::light_baking {

inline constexpr float kUnseen = std::numeric_limits<float>::infinity();

/// For each placement and side, the distance in metres from which each triangle is seen, or kUnseen; empty if no
/// triangle of that side is seen.
struct VisibleTriangles {
  std::vector<std::array<std::vector<float>, 2>> distance;
  std::uint64_t seen = 0;  ///< Triangles that are seen, each side counted.
};

/// Returns eye positions in the Scene frame, evenly distributed over the walkable area, at heights around the eye's.
[[nodiscard]] std::vector<Eigen::Vector3d> walkable_eyes(const scene::SceneInfo& info, int count, std::uint64_t seed);

/// Looks in all directions from walkable_eyes(). Triangles that are only visible through glass or in a mirror are not
/// found. `cancelled` may be null.
[[nodiscard]] VisibleTriangles find_visible_triangles(const render::Renderer& renderer, const BakeSettings& settings,
                                                      const std::function<bool()>& cancelled);

}  // namespace cyclorama::light_baking
