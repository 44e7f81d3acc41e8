// SPDX-License-Identifier: Apache-2.0
/// From a hit to a place on a surface: where it is, how sure that is, which way it faces, what it is made of.
#pragma once

#include "renderfarm/render/trace_scene.h"

namespace cyclorama {

/// Where a ray met a triangle: its corners' weights and vertices.
struct TriangleHit {
  const SurfaceMesh* mesh = nullptr;
  const Placement* placement = nullptr;
  std::array<std::uint32_t, 3> corners{};  ///< From triangle_at(): only if the mesh has texture coordinates.
  Vec3 weights = Vec3::Zero();
  const TriangleRecord* record = nullptr;
};

/// A place on a surface, in the render frame.
struct SurfacePoint {
  Vec3 position = Vec3::Zero();
  Vec3 error = Vec3::Zero();    ///< Bound of the position's error, per axis.
  Vec3 facing = Vec3::UnitY();  ///< The triangle's normal, on the viewer's side. Unit length.
  Vec3 normal = Vec3::UnitY();  ///< The shading normal, on the same side. Unit length.
  Vec3 colour = Vec3::Ones();   ///< Of the vertices, linear.
  bool front = true;            ///< The viewer is on the side that the triangle's winding faces.
};

/// Number of the placement that was hit: its instance, or the baked mesh itself.
[[nodiscard]] inline unsigned top_of(const RTCHit& hit) {
  return hit.instID[0] != RTC_INVALID_GEOMETRY_ID ? hit.instID[0] : hit.geomID;
}

[[nodiscard]] TriangleHit triangle_at(const TraceScene& scene, const RTCHit& hit);

/// `direction` is the ray's. The normal is the interpolated one; normal maps come after. Never NaN.
[[nodiscard]] SurfacePoint surface_at(const TriangleHit& hit, const Vec3& direction);

/// How much of a surface one sample stands for: a ray with a width. Source: Akenine-Möller et al., "Improved Shader and
/// Texture Level of Detail Using Ray Cones", JCGT 10(1), 2021.
struct Footprint {
  float width = 0.0f;   ///< Of the cone across the ray, where it hits. Zero: level 0 of every texture.
  float cosine = 1.0f;  ///< Between the ray and the triangle's normal; its size counts.
};

/// The level of `texture` whose texels are as large as `footprint` on the triangle, seen along its longer side: for
/// lookup(). Depends on the scene's scale as little as on its units; not above 0 where the texture has no extent, the
/// coarsest (infinite) where the triangle has none.
[[nodiscard]] float lod_of(const TriangleHit& hit, const TextureUse& use, const MipTexture& texture,
                           const Footprint& footprint);

/// The texture coordinates that `use` asks for, its transform applied; zero where the mesh has none.
[[nodiscard]] Vec2 texcoord_at(const TriangleHit& hit, const TextureUse& use);

/// The shading normal bent by the material's normal map, on the same side as before; `point.normal` where the mesh
/// gives the map no direction.
[[nodiscard]] Vec3 mapped_normal(const TriangleHit& hit, const SurfacePoint& point, const Footprint& footprint);

/// The same for the clear coat, which has a map of its own, or none.
[[nodiscard]] Vec3 coat_normal(const TriangleHit& hit, const SurfacePoint& point, const Footprint& footprint);

/// Only its alpha, for rays that look for holes.
[[nodiscard]] float alpha_at(const TriangleHit& hit);

/// A ray's start that is certainly on the side of the surface to which `side` (a unit normal) points.
/// Source: Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th edition, section 6.8.
[[nodiscard]] Vec3 start_off_surface(const SurfacePoint& point, const Vec3& side);

}  // namespace cyclorama
