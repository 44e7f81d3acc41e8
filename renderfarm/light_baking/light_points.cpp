// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/light_points.h"

#include <tbb/parallel_for.h>

#include "renderfarm/render/sampler.h"

namespace cyclorama::light_baking {
namespace {

using render::Vec3;

/// Distance of points from their surface, as a fraction of its triangles' edges; large enough that a neighbouring
/// triangle at a slight angle does not hide what is in front of the point.
constexpr float kOffEdge = 1e-3f;
/// Fraction by which points at the edge of a surface are moved into their largest triangle, because another surface may
/// touch the edge: in the corner of a room, a point exactly at the edge is inside the adjacent wall.
constexpr float kDrawnIn = 0.04f;
/// A vertex is at an edge if the angles around it add up to less than this; inside a surface they add up to about 2 pi.
constexpr float kEdgeAngle = 4.4f;
/// Minimum distance from the surface as a fraction of the coordinates: several times their rounding error.
constexpr float kOffPlace = 0x1p-20f;

Vec3 render_point(const render::Placement& placement, const Vec3& local) {
  return placement.baked ? local : Vec3(placement.linear * local + placement.translation);
}

Vec3 render_normal(const render::Placement& placement, const Vec3& local) {
  return render::normalized_or(placement.baked ? local : Vec3(placement.normal_matrix * local), Vec3::Zero());
}

/// Returns the normal of a triangle's front, by its winding, in the render frame; its length is twice the area.
Vec3 face_of(const render::Placement& placement, std::size_t triangle, const std::array<Vec3, 3>& corners) {
  Vec3 face = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  if (placement.baked) return face;
  // Mirroring an instance does not swap its outside and inside.
  const render::SurfaceMesh& mesh = *placement.mesh;
  std::array<Vec3, 3> local;
  for (std::size_t i = 0; i < 3; ++i) local[i] = render::to_vec3(mesh.positions[mesh.triangles[triangle][i]]);
  const Vec3 outside = placement.normal_matrix * (local[1] - local[0]).cross(local[2] - local[0]);
  return face.dot(outside) < 0.0f ? Vec3(-face) : face;
}

float shortest_edge(const std::array<Vec3, 3>& c) {
  return std::min({(c[1] - c[0]).norm(), (c[2] - c[1]).norm(), (c[0] - c[2]).norm()});
}

LightPoint make_point(const Vec3& on_surface, const Vec3& normal, const Vec3& facing, float edge, std::uint32_t seed) {
  LightPoint point;
  point.facing = facing;
  point.normal = normal.dot(facing) < 0.0f ? Vec3(-normal) : normal;
  point.off = std::max(kOffEdge * edge, kOffPlace * on_surface.cwiseAbs().maxCoeff());
  point.position = on_surface + facing * point.off;
  point.seed = seed;
  return point;
}

/// Sums over the triangles around each vertex.
struct VertexSums {
  Vec3 face = Vec3::Zero();
  /// Normal (twice the area long) and middle of the largest triangle. A mean over triangles that are not coplanar could
  /// be below one of them.
  Vec3 largest_face = Vec3::Zero();
  Vec3 largest_middle = Vec3::Zero();
  float angle = 0.0f;  ///< Sum of the triangles' angles at the vertex; about pi at a straight edge of the surface.
  float shortest_edge = std::numeric_limits<float>::infinity();
};

}  // namespace

const LightPoint& LightSpot::at(float choice) const {
  if (weights_up_to.empty()) return points[0];
  const auto found = std::ranges::upper_bound(weights_up_to, choice * weights_up_to.back());
  const auto i = static_cast<std::size_t>(found - weights_up_to.begin());
  return points[std::min(i, points.size() - 1)];
}

std::array<Vec3, 3> corners_of(const render::Placement& placement, std::size_t triangle) {
  const render::SurfaceMesh& mesh = *placement.mesh;
  std::array<Vec3, 3> corners;
  for (std::size_t i = 0; i < 3; ++i) {
    corners[i] = render_point(placement, render::to_vec3(mesh.positions[mesh.triangles[triangle][i]]));
  }
  return corners;
}

std::vector<LightPoint> base_points(const render::Placement& placement, std::uint32_t seed) {
  const render::SurfaceMesh& mesh = *placement.mesh;
  std::vector<LightPoint> points;
  if (mesh.normals == nullptr) {
    points.resize(mesh.triangle_count);
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
      points[i] =
          point_in(placement, i, Vec3::Constant(1.0f / 3.0f), render::mix_bits(seed + static_cast<std::uint32_t>(i)));
    });
    return points;
  }
  std::vector<VertexSums> sums(mesh.vertex_count);
  for (std::size_t t = 0; t < mesh.triangle_count; ++t) {
    const std::array<Vec3, 3> corners = corners_of(placement, t);
    const Vec3 face = face_of(placement, t, corners);
    const float edge = shortest_edge(corners);
    for (std::size_t i = 0; i < 3; ++i) {
      VertexSums& sum = sums[mesh.triangles[t][i]];
      sum.face += face;
      if (face.squaredNorm() > sum.largest_face.squaredNorm()) {
        sum.largest_face = face;
        sum.largest_middle = (corners[0] + corners[1] + corners[2]) / 3.0f;
      }
      const Vec3 ahead = corners[(i + 1) % 3] - corners[i];
      const Vec3 behind = corners[(i + 2) % 3] - corners[i];
      sum.angle += std::atan2(ahead.cross(behind).norm(), ahead.dot(behind));
      if (edge > 0.0f) sum.shortest_edge = std::min(sum.shortest_edge, edge);
    }
  }
  points.resize(mesh.vertex_count);
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    const bool is_at_edge = sums[i].angle < kEdgeAngle;
    const Vec3 facing = render::normalized_or(is_at_edge ? sums[i].largest_face : sums[i].face, Vec3::Zero());
    const Vec3 normal = render_normal(placement, render::to_vec3(mesh.normals[i]));
    if (facing.isZero(0.0f) || normal.isZero(0.0f) || !std::isfinite(sums[i].shortest_edge)) return;
    const Vec3 vertex = render_point(placement, render::to_vec3(mesh.positions[i]));
    Vec3 at = vertex;
    if (is_at_edge) at += kDrawnIn * (sums[i].largest_middle - vertex);
    points[i] =
        make_point(at, normal, facing, sums[i].shortest_edge, render::mix_bits(seed + static_cast<std::uint32_t>(i)));
  });
  return points;
}

LightPoint point_in(const render::Placement& placement, std::size_t triangle, const Vec3& weights, std::uint32_t seed) {
  const render::SurfaceMesh& mesh = *placement.mesh;
  const std::array<Vec3, 3> corners = corners_of(placement, triangle);
  const Vec3 facing = render::normalized_or(face_of(placement, triangle, corners), Vec3::Zero());
  if (facing.isZero(0.0f)) return {};
  Vec3 normal = facing;
  if (mesh.normals != nullptr) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < 3; ++i) {
      sum += weights[static_cast<Eigen::Index>(i)] * render::to_vec3(mesh.normals[mesh.triangles[triangle][i]]);
    }
    normal = render::normalized_or(render_normal(placement, sum), facing);
  }
  const Vec3 on_surface = weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
  return make_point(on_surface, normal, facing, shortest_edge(corners), seed);
}

LightPoint other_side(const LightPoint& point) {
  LightPoint other = point;
  other.position -= 2.0f * point.off * point.facing;
  other.normal = -point.normal;
  other.facing = -point.facing;
  other.seed = render::mix_bits(point.seed + 1);
  return other;
}

}  // namespace cyclorama::light_baking
