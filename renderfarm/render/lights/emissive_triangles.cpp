// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/lights/emissive_triangles.h"

#include <cmath>

#include "renderfarm/render/lights/spherical_triangle.h"
#include "renderfarm/render/surface.h"
#include "renderfarm/render/texture_lookup.h"

namespace cyclorama::render {
namespace {

/// Distance, in multiples of a triangle's size, beyond which it is sampled by area without computing its solid angle.
constexpr float kFarSizes = 32.0f;

/// Subdivisions of the lattice of barycentric weights at which a triangle's texture is averaged.
constexpr int kLattice = 4;

Vec3 centroid() { return Vec3::Constant(1.0f / 3.0f); }

/// Maps the unit square uniformly to the triangle, keeping neighbours together. Source: Heitz, "A Low-Distortion Map
/// Between Triangle and Square", 2019.
Vec3 uniform_weights(const Vec2& u) {
  float x = 0.5f * u.x();
  float y = 0.5f * u.y();
  const float offset = y - x;
  if (offset > 0.0f) {
    y += offset;
  } else {
    x -= offset;
  }
  return {x, y, std::max(0.0f, 1.0f - x - y)};
}

}  // namespace

Vec3 emitted_radiance(const TriangleHit& hit) {
  const SurfaceMaterial& material = *hit.mesh->material;
  const scene::Material& source = *material.source;
  if (material.emissive == nullptr) return source.emissive;
  const Vec2 uv = texcoord_at(hit, source.emissive_texture);
  return source.emissive.cwiseProduct(lookup(*material.emissive, uv, Coding::kSrgb, 0.0f).head<3>());
}

EmissiveTriangles::EmissiveTriangles(const std::vector<Placement>& placements)
    : placements_(placements.data()), numbers_(placements.size()) {
  for (std::size_t i = 0; i < placements.size(); ++i) {
    const SurfaceMesh& mesh = *placements[i].mesh;
    if (!(mesh.material->source->emissive.maxCoeff() > 0.0f) || mesh.triangle_count == 0) continue;
    numbers_[i].assign(mesh.triangle_count, -1);
    for (std::uint32_t primitive = 0; primitive < mesh.triangle_count; ++primitive) {
      Triangle triangle{static_cast<std::uint32_t>(i), primitive, 0.0f};
      const float area = 0.5f * corners_of(triangle).doubled_area().norm();
      if (mesh.material->emissive == nullptr) {
        triangle.luminance = luminance(mesh.material->source->emissive);
      } else {
        triangle.luminance = luminance(emitted_radiance(hit_at(triangle, centroid())));
        int places = 1;
        for (int a = 0; a <= kLattice; ++a) {
          for (int b = 0; a + b <= kLattice; ++b, ++places) {
            const Vec3 weights =
                Vec3(static_cast<float>(a), static_cast<float>(b), static_cast<float>(kLattice - a - b));
            triangle.luminance += luminance(emitted_radiance(hit_at(triangle, weights / kLattice)));
          }
        }
        triangle.luminance /= static_cast<float>(places);
      }
      if (!std::isnormal(area) || !std::isnormal(area * triangle.luminance)) continue;
      numbers_[i][primitive] = static_cast<std::int32_t>(triangles_.size());
      triangles_.push_back(triangle);
    }
  }
}

int EmissiveTriangles::find(unsigned placement, unsigned primitive) const {
  if (placement >= numbers_.size() || numbers_[placement].empty()) return -1;
  return numbers_[placement][primitive];
}

EmissiveTriangles::Corners EmissiveTriangles::corners_of(const Triangle& triangle) const {
  const Placement& placement = placements_[triangle.placement];
  const std::array<std::uint32_t, 3>& corners = placement.mesh->triangles[triangle.primitive];
  const auto corner = [&](std::size_t i) {
    const Vec3 position = to_vec3(placement.mesh->positions[corners[i]]);
    return placement.baked ? position : Vec3(placement.linear * position + placement.translation);
  };
  Corners placed{corner(0), corner(1), corner(2)};
  if (!placement.baked && placement.linear.determinant() < 0.0f) std::swap(placed.b, placed.c);
  return placed;
}

TriangleHit EmissiveTriangles::hit_at(const Triangle& triangle, const Vec3& weights) const {
  const Placement& placement = placements_[triangle.placement];
  TriangleHit hit;
  hit.placement = &placement;
  hit.mesh = placement.mesh;
  hit.corners = placement.mesh->triangles[triangle.primitive];
  hit.weights = weights;
  if (!placement.baked && placement.linear.determinant() < 0.0f) std::swap(hit.weights.y(), hit.weights.z());
  return hit;
}

bool EmissiveTriangles::is_double_sided(const Triangle& triangle) const {
  return placements_[triangle.placement].mesh->material->source->double_sided;
}

LightBounds EmissiveTriangles::bounds(std::size_t index) const {
  const Triangle& triangle = triangles_[index];
  const Corners corners = corners_of(triangle);
  const Vec3 doubled = corners.doubled_area();
  LightBounds bounds;
  bounds.low = corners.a.cwiseMin(corners.b).cwiseMin(corners.c);
  bounds.high = corners.a.cwiseMax(corners.b).cwiseMax(corners.c);
  bounds.normals = {normalized_or(doubled, Vec3::UnitY()), is_double_sided(triangle) ? -1.0f : 1.0f};
  bounds.cos_emission = 0.0f;
  bounds.power = 0.5f * doubled.norm() * triangle.luminance;
  return bounds;
}

namespace {

/// A triangle relative to the point that it lights.
struct SeenTriangle {
  Vec3 a, b, c;
  Vec3 doubled_area;

  [[nodiscard]] std::optional<SphericalTriangle> as_solid_angle() const {
    const float size2 = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    const float distance2 = std::min({a.squaredNorm(), b.squaredNorm(), c.squaredNorm()});
    if (distance2 > kFarSizes * kFarSizes * size2) return std::nullopt;
    return SphericalTriangle::see(a.cast<double>(), b.cast<double>(), c.cast<double>());
  }
  /// Returns the barycentric weights of the point where the line along `direction` meets the plane.
  [[nodiscard]] Vec3 weights_along(const Eigen::Vector3d& direction) const {
    const Eigen::Vector3d da = a.cast<double>();
    const Eigen::Vector3d db = b.cast<double>();
    const Eigen::Vector3d dc = c.cast<double>();
    Eigen::Vector3d weights(direction.dot(db.cross(dc)), direction.dot(dc.cross(da)), direction.dot(da.cross(db)));
    const double sum = weights.sum();
    if (sum == 0.0 || !std::isfinite(sum)) return centroid();
    weights = (weights / sum).cwiseMax(0.0);
    return (weights / weights.sum()).cast<float>();
  }
};

}  // namespace

bool EmissiveTriangles::sample(std::size_t index, const Vec3& p, const Vec2& u, LightSample* ret_sample) const {
  const Triangle& triangle = triangles_[index];
  const Corners corners = corners_of(triangle);
  const SeenTriangle seen{corners.a - p, corners.b - p, corners.c - p, corners.doubled_area()};
  const bool both_sides = is_double_sided(triangle);
  if (!both_sides && !(seen.a.dot(seen.doubled_area) < 0.0f)) return false;
  const std::optional<SphericalTriangle> spherical = seen.as_solid_angle();
  const Vec3 weights =
      spherical ? seen.weights_along(spherical->sample(static_cast<double>(u.x()), static_cast<double>(u.y())))
                : uniform_weights(u);
  const Vec3 way = weights.x() * seen.a + weights.y() * seen.b + weights.z() * seen.c;
  const float distance = way.norm();
  if (!(distance > 0.0f)) return false;
  const Vec3 direction = way / distance;
  const float doubled = seen.doubled_area.norm();
  const float cosine = std::abs(direction.dot(seen.doubled_area)) / doubled;
  const float solid_angle =
      spherical ? static_cast<float>(spherical->solid_angle()) : 0.5f * doubled * cosine / (distance * distance);
  if (!(solid_angle > 0.0f) || !std::isfinite(solid_angle)) return false;
  const TriangleHit hit = hit_at(triangle, weights);
  Vec3 radiance = emitted_radiance(hit);
  const SurfaceMaterial& material = *hit.mesh->material;
  if (material.blends) radiance *= std::clamp(alpha_at(hit), 0.0f, 1.0f);
  if (material.cut_out && alpha_at(hit) < material.source->alpha_cutoff) return false;
  *ret_sample = {direction, short_of(p, distance, cosine), radiance * solid_angle, 1.0f / solid_angle};
  return true;
}

float EmissiveTriangles::pdf(std::size_t index, const Vec3& p, const Vec3& direction, float distance) const {
  const Triangle& triangle = triangles_[index];
  const Corners corners = corners_of(triangle);
  const SeenTriangle seen{corners.a - p, corners.b - p, corners.c - p, corners.doubled_area()};
  if (!is_double_sided(triangle) && !(seen.a.dot(seen.doubled_area) < 0.0f)) return 0.0f;
  if (const std::optional<SphericalTriangle> spherical = seen.as_solid_angle()) {
    return 1.0f / static_cast<float>(spherical->solid_angle());
  }
  const float projected = 0.5f * std::abs(direction.dot(seen.doubled_area));
  return projected > 0.0f ? distance * distance / projected : 0.0f;
}

std::size_t EmissiveTriangles::bytes() const {
  std::size_t bytes = triangles_.capacity() * sizeof(Triangle);
  for (const std::vector<std::int32_t>& numbers : numbers_) bytes += numbers.capacity() * sizeof(std::int32_t);
  return bytes;
}

}  // namespace cyclorama::render
