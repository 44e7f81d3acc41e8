// SPDX-License-Identifier: Apache-2.0
/// Emissive triangles as lights: the triangles of meshes with an emissive material, once for each placement.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "renderfarm/render/lights/light_bounds.h"
#include "renderfarm/render/lights/light_sample.h"

namespace cyclorama::render {

struct Placement;
struct TriangleHit;

/// Returns the radiance emitted at the hit, seen from the front. Includes the colour of the emission's texture, not its
/// alpha.
[[nodiscard]] Vec3 emitted_radiance(const TriangleHit& hit);

/// The emissive triangles of a scene. A value; queries are thread-safe. Borrows the placements from which it was made;
/// they must neither move nor change.
///
/// Sampling covers a triangle's front, from which its corners appear counter-clockwise, and also its back if the
/// material is double-sided. Other backs emit light as well but are not sampled, nor are triangles whose texture is
/// black at all positions checked; rays that hit them still see their emission.
class EmissiveTriangles {
 public:
  EmissiveTriangles() = default;
  explicit EmissiveTriangles(const std::vector<Placement>& placements);

  [[nodiscard]] std::size_t size() const { return triangles_.size(); }
  /// Returns the number of a placement's triangle among the emissive triangles; -1 if it is not one of them.
  [[nodiscard]] int find(unsigned placement, unsigned primitive) const;
  [[nodiscard]] LightBounds bounds(std::size_t triangle) const;

  /// Samples a position; returns false if `u` leads to no light. Near triangles are sampled uniformly in solid angle,
  /// others by area. Source: Arvo, "Stratified Sampling of Spherical Triangles", 1995.
  [[nodiscard]] bool sample(std::size_t triangle, const Vec3& p, const Vec2& u, LightSample* ret_sample) const;
  /// Returns the pdf of sample() for a ray from `p` that hit the triangle after `distance`.
  [[nodiscard]] float pdf(std::size_t triangle, const Vec3& p, const Vec3& direction, float distance) const;
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Triangle {
    std::uint32_t placement = 0;
    std::uint32_t primitive = 0;
    float luminance = 0.0f;  ///< Mean of the emission.
  };
  struct Corners {
    Vec3 a, b, c;  ///< Render frame, counter-clockwise from the front.
    [[nodiscard]] Vec3 doubled_area() const { return (b - a).cross(c - a); }
  };
  [[nodiscard]] Corners corners_of(const Triangle& triangle) const;
  [[nodiscard]] TriangleHit hit_at(const Triangle& triangle, const Vec3& weights) const;
  [[nodiscard]] bool is_double_sided(const Triangle& triangle) const;

  const Placement* placements_ = nullptr;
  std::vector<Triangle> triangles_;
  /// Triangle numbers, by placement and primitive; empty for placements that do not emit.
  std::vector<std::vector<std::int32_t>> numbers_;
};

}  // namespace cyclorama::render
