// SPDX-License-Identifier: Apache-2.0
/// Triangles that glow, as lights: of meshes whose material is emissive, at each place where they stand.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "renderfarm/render/lights/light_bounds.h"
#include "renderfarm/render/lights/light_sample.h"

namespace cyclorama {

struct Placement;
struct TriangleHit;

/// What the surface gives off there, seen from its front. Colour of the emission's texture included, alpha not.
[[nodiscard]] Vec3 emitted_radiance(const TriangleHit& hit);

/// A value; queries are thread-safe. Borrows the placements that it was made of, which must stay where they are.
///
/// A triangle shines on its front, where its corners run counter-clockwise; a double-sided material's on both sides.
/// Seen from behind, other triangles glow as well, but no ray aims there. Those whose texture is black where it was
/// looked at are left out in the same way: rays that meet them by chance still see them glow.
class EmissiveTriangles {
 public:
  EmissiveTriangles() = default;
  explicit EmissiveTriangles(const std::vector<Placement>& placements);

  [[nodiscard]] std::size_t size() const { return triangles_.size(); }
  /// The number of a placement's triangle among these; -1 if it is none.
  [[nodiscard]] int find(unsigned placement, unsigned primitive) const;
  [[nodiscard]] LightBounds bounds(std::size_t triangle) const;

  /// False where `u` gives no light. Near triangles are sampled uniformly in solid angle, others by area. Source: Arvo,
  /// "Stratified Sampling of Spherical Triangles", 1995.
  [[nodiscard]] bool sample(std::size_t triangle, const Vec3& p, const Vec2& u, LightSample* ret_sample) const;
  /// That of sample() for a ray from `p` that met the triangle after `distance`.
  [[nodiscard]] float density(std::size_t triangle, const Vec3& p, const Vec3& direction, float distance) const;
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
  /// By placement and triangle: the number here; empty for placements that do not glow.
  std::vector<std::vector<std::int32_t>> numbers_;
};

}  // namespace cyclorama
