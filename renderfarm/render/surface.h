// SPDX-License-Identifier: Apache-2.0
/// Geometry of a hit: position with its error bound, normals, texture coordinates.
#pragma once

#include "renderfarm/render/texture_lookup.h"
#include "renderfarm/render/trace_scene.h"

namespace cyclorama::render {

/// A ray's hit on a triangle: barycentric weights and vertices of its corners. A value.
struct TriangleHit {
  const SurfaceMesh* mesh = nullptr;
  const Placement* placement = nullptr;
  std::array<std::uint32_t, 3> corners{};  ///< Set by triangle_at() only if the mesh has texture coordinates.
  Vec3 weights = Vec3::Zero();
  const TriangleRecord* stored = nullptr;  ///< Null if the mesh has no records.
  TriangleRecord read;                     ///< Not initialised if `stored` is set.

  [[nodiscard]] const TriangleRecord& record() const { return stored != nullptr ? *stored : read; }
  /// Sets `mesh`, `placement`, and the triangle's record.
  void find_triangle(const Placement& at, std::uint32_t triangle) {
    placement = &at;
    mesh = at.mesh;
    if (!mesh->records.empty()) {
      stored = &mesh->records[triangle];
    } else {
      read_triangle({mesh->positions, mesh->normals, mesh->colours}, mesh->triangles[triangle], &read);
    }
  }
};

/// A point on a surface, in the render frame.
struct SurfacePoint {
  Vec3 position = Vec3::Zero();
  Vec3 error = Vec3::Zero();    ///< Upper bound of the position's error, per axis.
  Vec3 facing = Vec3::UnitY();  ///< The triangle's normal, on the viewer's side. Unit length.
  Vec3 normal = Vec3::UnitY();  ///< The shading normal, on the viewer's side. Unit length.
  Vec3 colour = Vec3::Ones();   ///< Interpolated vertex colour, linear.
  bool front = true;            ///< True if the viewer is on the front, as given by the triangle's winding.
};

/// Returns the index of the placement that was hit: the instance, or the baked mesh itself.
[[nodiscard]] inline unsigned top_of(const RTCHit& hit) {
  return hit.instID[0] != RTC_INVALID_GEOMETRY_ID ? hit.instID[0] : hit.geomID;
}

[[nodiscard]] inline Vec3 barycentric_weights(const RTCHit& hit) {
  return {std::max(0.0f, 1.0f - hit.u - hit.v), hit.u, hit.v};
}

[[nodiscard]] TriangleHit triangle_at(const TraceScene& scene, const RTCHit& hit);

/// Returns the point that was hit; `direction` is the ray's. The normal is interpolated, without the normal map. No
/// value is NaN.
[[nodiscard]] SurfacePoint surface_at(const TriangleHit& hit, const Vec3& direction);

/// Returns the interpolated vertex colour, linear. Precondition: the mesh has vertex colours.
[[nodiscard]] inline Vec3 vertex_colour(const TriangleHit& hit) {
  const std::array<float, 256>& linear = srgb_table();
  std::array<float, 3> sum{};
  for (std::size_t i = 0; i < 3; ++i) {
    const float weight = hit.weights[static_cast<Eigen::Index>(i)];
    for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * linear[hit.record().colours[i][c]];
  }
  return to_vec3(sum);
}

/// The area of a surface that one sample covers, described by the width of its ray. Source: Akenine-Möller et al.,
/// "Improved Shader and Texture Level of Detail Using Ray Cones", JCGT 10(1), 2021.
struct Footprint {
  /// Width of the cone across the ray, where it hits, in metres. Zero selects level 0 of every texture.
  float width = 0.0f;
  float cosine = 1.0f;  ///< Absolute cosine between the ray and the triangle's normal.
};

/// Returns the level of `texture` for lookup() whose texels are as large as `footprint` on the triangle, measured along
/// its longer side. The level does not depend on the scene's scale and units. It is at most 0 if the texture has no
/// extent, and infinite (the coarsest level) if the triangle has no area.
[[nodiscard]] float lod_of(const TriangleHit& hit, const scene::TextureUse& use, const MipTexture& texture,
                           const Footprint& footprint);

/// Returns the texture coordinates that `use` selects, transformed; zero if the mesh has none.
[[nodiscard]] Vec2 texcoord_at(const TriangleHit& hit, const scene::TextureUse& use);

/// Returns the shading normal perturbed by the material's normal map, on the same side as before; `point.normal` if the
/// mesh defines no tangents for the map.
[[nodiscard]] Vec3 mapped_normal(const TriangleHit& hit, const SurfacePoint& point, const Footprint& footprint);

/// Returns the clear coat's normal in the same way; the coat has a separate normal map or none.
[[nodiscard]] Vec3 coat_normal(const TriangleHit& hit, const SurfacePoint& point, const Footprint& footprint);

/// Returns the material's alpha at the hit, for alpha_filter().
[[nodiscard]] float alpha_at(const TriangleHit& hit);

/// Returns a starting point for rays that is certainly on the side of the surface to which the unit normal `side`
/// points. Source: Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th edition, section 6.8.
[[nodiscard]] Vec3 start_off_surface(const SurfacePoint& point, const Vec3& side);

}  // namespace cyclorama::render
