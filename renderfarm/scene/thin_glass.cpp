// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/thin_glass.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

namespace cyclorama::scene {
namespace {

using Eigen::Vector3d;

constexpr double kMaxThicknessM = 0.03;
/// Maximum thickness of a plate as a share of its diagonal; a paperweight is no plate.
constexpr double kMaxShareOfDiagonal = 0.1;
constexpr double kMaxAngleRad = 6.0 * std::numbers::pi / 180.0;  ///< Tessellated shells are parallel up to this.
/// The narrow sides of a plate are the rest.
constexpr double kMinShareOfArea = 0.85;
constexpr std::size_t kMaxSamples = 200;
constexpr std::size_t kMinSamples = 32;
constexpr std::size_t kMaxTests = 20'000'000;
constexpr std::size_t kMaxPlateTriangles = kMaxTests / kMinSamples;

struct Corners {
  Vector3d a, ab, ac;
};

Corners corners_of(const Mesh& mesh, std::size_t triangle) {
  const auto corner = [&](std::size_t i) {
    const std::array<float, 3>& p = mesh.positions[mesh.triangles[triangle][i]];
    return Vector3d(double{p[0]}, double{p[1]}, double{p[2]});
  };
  const Vector3d a = corner(0);
  return {a, corner(1) - a, corner(2) - a};
}

/// Returns the distance along `direction`, which has unit length, to a triangle; null if it is not hit.
std::optional<double> distance_to(const Corners& triangle, const Vector3d& start, const Vector3d& direction) {
  const Vector3d p = direction.cross(triangle.ac);
  const double determinant = triangle.ab.dot(p);
  if (determinant == 0.0) return std::nullopt;
  const Vector3d from = start - triangle.a;
  const double u = from.dot(p) / determinant;
  const Vector3d q = from.cross(triangle.ab);
  const double v = direction.dot(q) / determinant;
  if (!(u >= 0.0 && v >= 0.0 && u + v <= 1.0)) return std::nullopt;
  return triangle.ac.dot(q) / determinant;
}

/// The point at which a line that enters the mesh leaves it.
struct Exit {
  double distance = std::numeric_limits<double>::infinity();
  Vector3d normal = Vector3d::Zero();
};

Exit exit_of(const std::vector<Corners>& triangles, std::size_t from, const Vector3d& start,
             const Vector3d& direction) {
  Exit exit;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (i == from) continue;
    const std::optional<double> distance = distance_to(triangles[i], start, direction);
    if (distance && *distance > 0.0 && *distance < exit.distance) {
      exit = {*distance, triangles[i].ab.cross(triangles[i].ac)};
    }
  }
  return exit;
}

double fraction(double value) { return value - std::floor(value); }

/// Returns a point of a triangle; the points of successive numbers spread evenly over it.
Vector3d point_in(const Corners& triangle, std::size_t number) {
  double u = fraction(0.5 + 0.7548776662466927 * static_cast<double>(number));
  double v = fraction(0.5 + 0.5698402909980532 * static_cast<double>(number));
  if (u + v > 1.0) {
    u = 1.0 - u;
    v = 1.0 - v;
  }
  return triangle.a + u * triangle.ab + v * triangle.ac;
}

bool is_clear_body(const Material& material) {
  constexpr float kSmooth = 0.03f;  // Rougher glass blurs what is behind it.
  return material.transmission > 0.0f && material.thickness > 0.0f && material.roughness < kSmooth;
}

double placed_scale(const Eigen::Affine3d& T) { return std::cbrt(std::abs(T.linear().determinant())); }

/// Returns the thin material that stands for both faces of a plate.
Material thin_of(const Material& body, double thickness_m) {
  Material thin = body;
  thin.thickness = 0.0f;
  if (body.attenuation_distance > 0.0f) {
    const auto exponent = static_cast<float>(0.5 * thickness_m / double{body.attenuation_distance});
    thin.base_colour.head<3>().array() *= body.attenuation_colour.array().max(0.0f).pow(exponent);
  }
  thin.attenuation_distance = 0.0f;
  return thin;
}

}  // namespace

std::optional<double> plate_thickness_m(const Mesh& mesh, double metres_per_unit) {
  if (mesh.triangles.empty() || mesh.triangles.size() > kMaxPlateTriangles) return std::nullopt;
  std::vector<Corners> triangles;
  std::vector<double> area_before;
  double area = 0.0;
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    triangles.push_back(corners_of(mesh, i));
    const Corners& t = triangles.back();
    box.extend(t.a).extend(t.a + t.ab).extend(t.a + t.ac);
    area_before.push_back(area);
    area += t.ab.cross(t.ac).norm();
  }
  if (!(area > 0.0)) return std::nullopt;
  const double max_thickness = std::min(kMaxThicknessM / metres_per_unit, kMaxShareOfDiagonal * box.diagonal().norm());
  const std::size_t samples = std::clamp(kMaxTests / triangles.size(), kMinSamples, kMaxSamples);
  std::size_t parallel = 0;
  double sum = 0.0;
  for (std::size_t i = 0; i < samples; ++i) {
    const double place = area * (static_cast<double>(i) + 0.5) / static_cast<double>(samples);
    const auto above = std::upper_bound(area_before.begin(), area_before.end(), place);
    const auto from = static_cast<std::size_t>(above - area_before.begin()) - 1;
    const Vector3d inwards = -triangles[from].ab.cross(triangles[from].ac).normalized();
    const Exit exit = exit_of(triangles, from, point_in(triangles[from], i), inwards);
    if (!(exit.distance <= max_thickness)) continue;
    if (exit.normal.normalized().dot(inwards) < std::cos(kMaxAngleRad)) continue;
    ++parallel;
    sum += exit.distance;
  }
  if (static_cast<double>(parallel) < kMinShareOfArea * static_cast<double>(samples)) return std::nullopt;
  return metres_per_unit * sum / static_cast<double>(parallel);
}

void make_plates_thin(Model* model) {
  std::vector<double> scales(model->meshes.size(), 0.0);
  for (const Instance& instance : model->instances) {
    double& scale = scales[static_cast<std::size_t>(instance.mesh)];
    scale = std::max(scale, placed_scale(instance.T_model_mesh));
  }
  std::map<int, int> thin_materials;  ///< The thin material of each body's.
  for (std::size_t i = 0; i < model->meshes.size(); ++i) {
    Mesh& mesh = model->meshes[i];
    const Material& body = model->materials[static_cast<std::size_t>(mesh.material)];
    if (!is_clear_body(body) || !(scales[i] > 0.0)) continue;
    const std::optional<double> thickness_m = plate_thickness_m(mesh, scales[i]);
    if (!thickness_m) continue;
    const auto [known, is_new] = thin_materials.emplace(mesh.material, static_cast<int>(model->materials.size()));
    if (is_new) {
      model->notes.push_back(
          fmt::format("'{}' is glass in plates {:.1f} mm thick: light crosses them straight, without refraction",
                      body.name, 1e3 * *thickness_m));
      model->materials.push_back(thin_of(body, *thickness_m));
    }
    mesh.material = known->second;
  }
}

}  // namespace cyclorama::scene
