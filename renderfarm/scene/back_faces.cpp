// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/back_faces.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace cyclorama::scene {
namespace {

constexpr std::size_t kLevelRays = 16;
constexpr std::size_t kMaxTriangles = 500'000;

struct Nearest {
  double distance = std::numeric_limits<double>::infinity();
  bool is_back = false;
};

using Rays = std::array<Eigen::Vector3d, kLevelRays>;

/// Updates the nearest hit of each ray from the origin with the triangle a, b, c.
void cast_all(const Rays& rays, const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
              std::array<Nearest, kLevelRays>* nearest) {
  // Horizontal rays miss a triangle that is wholly above or below the eye.
  if ((a.y() > 0.0) == (b.y() > 0.0) && (b.y() > 0.0) == (c.y() > 0.0)) return;
  const Eigen::Vector3d ab = b - a;
  const Eigen::Vector3d ac = c - a;
  const Eigen::Vector3d normal = ab.cross(ac);
  const double plane = normal.dot(a);
  for (std::size_t i = 0; i < kLevelRays; ++i) {
    const double facing = normal.dot(rays[i]);
    if (facing == 0.0) continue;
    const double distance = plane / facing;
    if (!(distance > 0.0) || distance >= (*nearest)[i].distance) continue;
    const Eigen::Vector3d p = distance * rays[i];
    const bool is_inside = normal.dot(ab.cross(p - a)) >= 0.0 && normal.dot((c - b).cross(p - b)) >= 0.0 &&
                           normal.dot((a - c).cross(p - c)) >= 0.0;
    if (is_inside) (*nearest)[i] = {distance, facing > 0.0};
  }
}

}  // namespace

std::optional<double> back_face_share(const Model& model, const Eigen::Vector3d& eye) {
  std::size_t triangles = 0;
  for (const Instance& instance : model.instances) {
    triangles += model.meshes[static_cast<std::size_t>(instance.mesh)].triangles.size();
  }
  if (triangles > kMaxTriangles) return std::nullopt;
  Rays rays;
  for (std::size_t i = 0; i < kLevelRays; ++i) {
    // The half step avoids rays along the edges of things that are parallel to the axes.
    const double angle = 2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) / kLevelRays;
    rays[i] = {std::sin(angle), 0.0, std::cos(angle)};
  }
  std::array<Nearest, kLevelRays> nearest;
  for (const Instance& instance : model.instances) {
    const Mesh& mesh = model.meshes[static_cast<std::size_t>(instance.mesh)];
    const auto corner = [&](std::uint32_t index) -> Eigen::Vector3d {
      const auto& p = mesh.positions[index];
      return instance.T_model_mesh * (mesh.origin + Eigen::Vector3d(double{p[0]}, double{p[1]}, double{p[2]})) - eye;
    };
    const bool is_mirrored = instance.T_model_mesh.linear().determinant() < 0.0;
    for (const auto& t : mesh.triangles) {
      const Eigen::Vector3d b = corner(t[1]);
      const Eigen::Vector3d c = corner(t[2]);
      cast_all(rays, corner(t[0]), is_mirrored ? c : b, is_mirrored ? b : c, &nearest);
    }
  }
  double hits = 0.0;
  double backs = 0.0;
  for (const Nearest& hit : nearest) {
    hits += std::isfinite(hit.distance) ? 1.0 : 0.0;
    backs += hit.is_back ? 1.0 : 0.0;
  }
  return hits > 0.0 ? backs / hits : 0.0;
}

}  // namespace cyclorama::scene
