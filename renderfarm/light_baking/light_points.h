// SPDX-License-Identifier: Apache-2.0
/// The points of a scene's surfaces at which light is computed.
#pragma once

#include <span>
#include <vector>

#include "renderfarm/render/trace_scene.h"

namespace cyclorama::light_baking {

/// A point on one side of a surface, in the render frame. Rays start at `position`, slightly off the surface.
struct LightPoint {
  render::Vec3 position = render::Vec3::Zero();
  render::Vec3 normal = render::Vec3::Zero();  ///< Shading normal; zero if there is no surface.
  render::Vec3 facing = render::Vec3::Zero();  ///< Geometric normal on the same side.
  float off = 0.0f;                            ///< Distance from the surface to `position`.
  std::uint32_t seed = 0;                      ///< Seed of its random numbers.

  [[nodiscard]] bool exists() const { return !normal.isZero(0.0f); }
};

/// The points from which the rays of one sample start, chosen at random by weight. `weights_up_to` are the cumulative
/// weights; empty for a single point.
struct LightSpot {
  std::vector<LightPoint> points{};
  std::vector<float> weights_up_to{};
  std::uint32_t seed = 0;

  LightSpot() = default;
  explicit LightSpot(const LightPoint& point) : points{point}, seed(point.seed) {}
  [[nodiscard]] bool exists() const { return !points.empty() && points[0].exists(); }
  /// Returns the point for a random number in [0, 1).
  [[nodiscard]] const LightPoint& at(float choice) const;
};

/// Returns the corners of a triangle in the render frame.
[[nodiscard]] std::array<render::Vec3, 3> corners_of(const render::Placement& placement, std::size_t triangle);

/// Returns the points of a placement's base samples, on its front: one per vertex, or one per triangle for a mesh
/// without normals. Uses the threads of the TBB arena in which it is called.
[[nodiscard]] std::vector<LightPoint> base_points(const render::Placement& placement, std::uint32_t seed);

/// Returns the point with these barycentric weights on the front of a triangle.
[[nodiscard]] LightPoint point_in(const render::Placement& placement, std::size_t triangle, const render::Vec3& weights,
                                  std::uint32_t seed);

/// Returns the point on the other side of the surface.
[[nodiscard]] LightPoint other_side(const LightPoint& point);

}  // namespace cyclorama::light_baking
