// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/surface.h"

#include <bit>
#include <cmath>
#include <limits>

#include "renderfarm/render/texture_lookup.h"

namespace cyclorama::render {
namespace {

constexpr float kUnit = 0.5f * std::numeric_limits<float>::epsilon();
/// Rounding errors of the weighted sum, of the placement, and of the traversal, which computed the hit from the ray's
/// start.
constexpr float kPositionRoundings = 8.0f * kUnit;
constexpr float kPlacementRoundings = 8.0f * kUnit;
/// The traversal's error grows with the triangle: its normal and its distance are computed from differences of the
/// corners.
constexpr float kExtentRoundings = 16.0f * kUnit;

/// Returns the next float after `value` in the direction of `direction`'s sign, which makes up for the rounding of a
/// sum. Equals std::nextafter without the function call.
float stepped(float value, float direction) {
  if (direction == 0.0f || !(std::abs(value) > std::numeric_limits<float>::min())) return value;
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return std::bit_cast<float>((value > 0.0f) == (direction > 0.0f) ? bits + 1 : bits - 1);
}

Vec3 corner(const TriangleHit& hit, int i) {
  return to_vec3(hit.mesh->positions[hit.corners[static_cast<std::size_t>(i)]]);
}

template <typename Array>
Vec3 interpolated3(const Array* values, const TriangleHit& hit) {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    const auto& v = values[hit.corners[static_cast<std::size_t>(i)]];
    sum += hit.weights[i] * Vec3(v[0], v[1], v[2]);
  }
  return sum;
}

/// The directions, in the mesh's frame, of a normal map's x and y. Zero if there are none.
struct TangentPlane {
  Vec3 x = Vec3::Zero();
  Vec3 y = Vec3::Zero();
};

/// Derives the plane from the texture coordinates: x along u, and y against v, because v points down.
TangentPlane plane_of_texcoords(const TriangleHit& hit, int set) {
  const std::array<float, 2>* const uv = hit.mesh->texcoords[static_cast<std::size_t>(set)];
  if (uv == nullptr) return {};
  const Vec2 uv0 = to_vec2(uv[hit.corners[0]]);
  const Vec2 d1 = to_vec2(uv[hit.corners[1]]) - uv0;
  const Vec2 d2 = to_vec2(uv[hit.corners[2]]) - uv0;
  const float area = d1.x() * d2.y() - d1.y() * d2.x();
  if (area == 0.0f || !std::isfinite(area)) return {};
  const float sign = std::copysign(1.0f, area);
  const Vec3 e1 = corner(hit, 1) - corner(hit, 0);
  const Vec3 e2 = corner(hit, 2) - corner(hit, 0);
  return {(e1 * d2.y() - e2 * d1.y()) * sign, (e1 * d2.x() - e2 * d1.x()) * sign};
}

/// Interpolates the vertex normals. Mesh frame; not unit length, may be zero.
Vec3 smooth_normal(const TriangleHit& hit) {
  return hit.weights[0] * hit.record().normal(0) + hit.weights[1] * hit.record().normal(1) +
         hit.weights[2] * hit.record().normal(2);
}

/// Returns the mesh's normal, whichever side is seen. Mesh frame; not unit length, may be zero.
Vec3 own_normal(const TriangleHit& hit) {
  if (hit.mesh->normals != nullptr) return smooth_normal(hit);
  return (corner(hit, 1) - corner(hit, 0)).cross(corner(hit, 2) - corner(hit, 0));
}

TangentPlane tangent_plane(const TriangleHit& hit, int set) {
  if (hit.mesh->tangents == nullptr) return plane_of_texcoords(hit, set);
  const Vec3 x = interpolated3(hit.mesh->tangents, hit);
  const float handedness = std::copysign(1.0f, hit.mesh->tangents[hit.corners[0]][3]);
  return {x, own_normal(hit).cross(x) * handedness};
}

/// Returns the point's normal perturbed by a normal map. `map` may be null.
Vec3 bent_normal(const TriangleHit& hit, const SurfacePoint& point, const MipTexture* map, const scene::TextureUse& use,
                 float scale, const Footprint& footprint) {
  if (map == nullptr) return point.normal;
  const Eigen::Vector4f texel = lookup(*map, texcoord_at(hit, use), Coding::kLinear, lod_of(hit, use, *map, footprint));
  const Vec3 bump((2.0f * texel.x() - 1.0f) * scale, (2.0f * texel.y() - 1.0f) * scale, 2.0f * texel.z() - 1.0f);

  const TangentPlane local = tangent_plane(hit, use.texcoord);
  const Placement& placement = *hit.placement;
  const Vec3 x = placement.baked ? local.x : Vec3(placement.linear * local.x);
  const Vec3 y = placement.baked ? local.y : Vec3(placement.linear * local.y);
  const Vec3& n = point.normal;
  const Vec3 unit_x = normalized_or(x - n * n.dot(x), Vec3::Zero());
  const Vec3 across = n.cross(unit_x);
  const Vec3 unit_y = across.dot(y) < 0.0f ? Vec3(-across) : across;
  if (unit_x.isZero(0.0f) || y.isZero(0.0f)) return n;
  // On a surface seen from behind, n was flipped to the viewer, so the perturbation is flipped too.
  const Vec3 own = own_normal(hit);
  const float side = n.dot(placement.baked ? own : Vec3(placement.normal_matrix * own)) < 0.0f ? -1.0f : 1.0f;
  const Vec3 bent = normalized_or((bump.x() * unit_x + bump.y() * unit_y) * side + bump.z() * n, n);
  return bent.dot(point.facing) > 0.0f ? bent : n;
}

}  // namespace

TriangleHit triangle_at(const TraceScene& scene, const RTCHit& hit) {
  TriangleHit at;
  at.find_triangle(scene.placements[top_of(hit)], hit.primID);
  if (at.mesh->texcoords[0] != nullptr || at.mesh->texcoords[1] != nullptr) at.corners = at.mesh->triangles[hit.primID];
  at.weights = barycentric_weights(hit);
  return at;
}

SurfacePoint surface_at(const TriangleHit& hit, const Vec3& direction) {
  const Placement& placement = *hit.placement;
  const TriangleRecord& record = hit.record();
  const Vec3 p0 = record.corner(0);
  const Vec3 p1 = record.corner(1);
  const Vec3 p2 = record.corner(2);
  const Vec3& w = hit.weights;

  SurfacePoint point;
  const Vec3 local = w[0] * p0 + w[1] * p1 + w[2] * p2;
  const Vec3 extent = p0.cwiseMax(p1).cwiseMax(p2) - p0.cwiseMin(p1).cwiseMin(p2);
  const Vec3 sum = w[0] * p0.cwiseAbs() + w[1] * p1.cwiseAbs() + w[2] * p2.cwiseAbs();
  const Vec3 local_error = kPositionRoundings * sum + Vec3::Constant(kExtentRoundings * extent.maxCoeff());
  const Vec3 local_face = (p1 - p0).cross(p2 - p0);
  Vec3 face;
  if (placement.baked) {
    point.position = local;
    point.error = local_error;
    face = local_face;
  } else {
    point.position = placement.linear * local + placement.translation;
    const Eigen::Matrix3f absolute = placement.linear.cwiseAbs();
    point.error =
        absolute * local_error + kPlacementRoundings * (absolute * local.cwiseAbs() + placement.translation.cwiseAbs());
    face = placement.normal_matrix * normalized_or(local_face, -direction);
  }
  point.facing = normalized_or(face, -direction);
  point.front = !(point.facing.dot(direction) > 0.0f);
  if (!point.front) point.facing = -point.facing;

  point.normal = point.facing;
  if (hit.mesh->normals != nullptr) {
    const Vec3 smooth = smooth_normal(hit);
    point.normal = normalized_or(placement.baked ? smooth : Vec3(placement.normal_matrix * smooth), point.facing);
    // The winding of scans is arbitrary, and a normal may disagree with its triangle: the viewer's side decides.
    if (point.normal.dot(point.facing) < 0.0f) point.normal = -point.normal;
  }
  if (hit.mesh->colours != nullptr) point.colour = vertex_colour(hit);
  return point;
}

Vec2 texcoord_at(const TriangleHit& hit, const scene::TextureUse& use) {
  const std::array<float, 2>* const uv = hit.mesh->texcoords[static_cast<std::size_t>(use.texcoord)];
  if (uv == nullptr) return Vec2::Zero();
  const Vec2 at = hit.weights[0] * to_vec2(uv[hit.corners[0]]) + hit.weights[1] * to_vec2(uv[hit.corners[1]]) +
                  hit.weights[2] * to_vec2(uv[hit.corners[2]]);
  return use.transform.leftCols<2>() * at + use.transform.col(2);
}

float lod_of(const TriangleHit& hit, const scene::TextureUse& use, const MipTexture& texture,
             const Footprint& footprint) {
  const std::array<float, 2>* const uv = hit.mesh->texcoords[static_cast<std::size_t>(use.texcoord)];
  if (uv == nullptr || texture.levels().empty() || !(footprint.width > 0.0f)) return 0.0f;
  const Vec2 uv0 = to_vec2(uv[hit.corners[0]]);
  const Vec2 d1 = to_vec2(uv[hit.corners[1]]) - uv0;
  const Vec2 d2 = to_vec2(uv[hit.corners[2]]) - uv0;
  const MipTexture::Level& full = texture.levels().front();
  const float texels = std::abs((d1.x() * d2.y() - d1.y() * d2.x()) * use.transform.leftCols<2>().determinant()) *
                       (static_cast<float>(full.width) * static_cast<float>(full.height));
  Vec3 e1 = corner(hit, 1) - corner(hit, 0);
  Vec3 e2 = corner(hit, 2) - corner(hit, 0);
  if (!hit.placement->baked) {
    e1 = hit.placement->linear * e1;
    e2 = hit.placement->linear * e2;
  }
  // Both areas are doubled. The scale per axis is the square root of their ratio, which is a factor of one half in
  // logarithms.
  const float across = footprint.width / footprint.cosine;
  return 0.5f * std::log2(texels / e1.cross(e2).norm() * (across * across));
}

Vec3 mapped_normal(const TriangleHit& hit, const SurfacePoint& point, const Footprint& footprint) {
  const SurfaceMaterial& material = *hit.mesh->material;
  return bent_normal(hit, point, material.normal, material.source->normal_texture, material.source->normal_scale,
                     footprint);
}

Vec3 coat_normal(const TriangleHit& hit, const SurfacePoint& point, const Footprint& footprint) {
  const SurfaceMaterial& material = *hit.mesh->material;
  return bent_normal(hit, point, material.clearcoat_normal, material.source->clearcoat_normal_texture,
                     material.source->clearcoat_normal_scale, footprint);
}

float alpha_at(const TriangleHit& hit) {
  const SurfaceMaterial& material = *hit.mesh->material;
  float alpha = material.source->base_colour.w();
  if (hit.mesh->colours != nullptr) {
    float opacity = 0.0f;
    for (int i = 0; i < 3; ++i) {
      opacity += hit.weights[i] * linear_table()[hit.mesh->colours[hit.corners[static_cast<std::size_t>(i)]][3]];
    }
    alpha *= opacity;
  }
  if (material.base_colour != nullptr) {
    alpha *= lookup_alpha(*material.base_colour, texcoord_at(hit, material.source->base_colour_texture));
  }
  return alpha;
}

Vec3 start_off_surface(const SurfacePoint& point, const Vec3& side) {
  const Vec3 moved = point.position + side * side.cwiseAbs().dot(point.error);
  Vec3 start;
  for (int axis = 0; axis < 3; ++axis) start[axis] = stepped(moved[axis], side[axis]);
  return start;
}

}  // namespace cyclorama::render
