// SPDX-License-Identifier: Apache-2.0
/// A display case of five plates of glass with a sphere inside. Light and eye are outside of it.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "tests/data_sets/simple_scenes.h"

namespace cyclorama {

/// A closed box about the origin, its triangles' fronts outside.
inline scene::Mesh box_mesh(const Eigen::Vector3f& size, int material = 0) {
  constexpr std::array<std::array<std::uint32_t, 4>, 6> kFaces = {
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  scene::Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    const auto sign = [&](int axis) { return (i >> axis & 1) != 0 ? 0.5f : -0.5f; };
    mesh.positions.push_back({sign(0) * size.x(), sign(1) * size.y(), sign(2) * size.z()});
  }
  for (const std::array<std::uint32_t, 4>& f : kFaces) {
    mesh.triangles.push_back({f[0], f[1], f[2]});
    mesh.triangles.push_back({f[0], f[2], f[3]});
  }
  mesh.material = material;
  return mesh;
}

/// Clear glass of which meshes are bodies.
inline scene::Material body_of_glass() {
  scene::Material material = matte_material(Eigen::Vector3f::Ones());
  material.name = "glass";
  material.roughness = 0.0f;
  material.transmission = 1.0f;
  material.thickness = 0.006f;
  return material;
}

enum class VitrineLight { kDisk, kBulb, kSky };
inline constexpr std::array kVitrineLights = {VitrineLight::kDisk, VitrineLight::kBulb, VitrineLight::kSky};

inline const char* name_of(VitrineLight light) {
  if (light == VitrineLight::kDisk) return "a disk of 80 cm";
  return light == VitrineLight::kBulb ? "a bulb of 30 cm" : "a sky";
}

/// The plates are 6 mm thick; their material is number 1.
inline scene::Scene vitrine(VitrineLight light) {
  constexpr float kThick = 0.006f;
  constexpr double kOut = 0.303;  // Distance of the plates' middles.
  scene::Scene scene = scene_of(square_mesh(6.0f), Eigen::Vector3f::Constant(0.4f));
  scene.model.materials.push_back(body_of_glass());
  const auto at = [](double x, double y, double z) { return Eigen::Affine3d(Eigen::Translation3d(x, y, z)); };
  add_mesh(scene, box_mesh({0.5f, 0.9f, 0.5f}), at(0, 0.45, 0));
  add_mesh(scene, sphere_mesh(0.15f, 64), at(0, 1.2, 0));
  for (const double side : {-kOut, kOut}) {
    add_mesh(scene, box_mesh({kThick, 0.6f, 0.6f}, 1), at(side, 1.2, 0));
    add_mesh(scene, box_mesh({0.6f, 0.6f, kThick}, 1), at(0, 1.2, side));
  }
  add_mesh(scene, box_mesh({0.61f, kThick, 0.61f}, 1), at(0, 1.504, 0));
  if (light == VitrineLight::kSky) {
    scene.sky = {Eigen::Vector3f::Ones(), Eigen::Vector3f::Constant(0.5f), Eigen::Vector3f::Zero()};
    return scene;
  }
  scene::Light lamp = point_light({0.9, 2.4, 1.2}, 10.0f);
  lamp.visible = true;
  lamp.radius_m = 0.15;
  if (light == VitrineLight::kDisk) {
    lamp.kind = scene::LightKind::kDisk;
    lamp.position = {0.4, 3.0, 0.6};
    lamp.radius_m = 0.4;
  }
  scene.model.lights.push_back(lamp);
  return scene;
}

/// A view through the front plate in which every pixel shows the sphere.
inline render::PanoramaView view_into_vitrine(int side_px, int samples, int bounces, std::uint64_t seed) {
  constexpr double kHalf = 0.06;  // The sphere's is 0.083.
  render::PanoramaView view = view_from({0, 1.2, 1.8}, side_px, side_px, kHalf, -kHalf);
  view.panorama.azimuth_span_rad = 2.0 * kHalf;
  view.quality.samples = samples;
  view.quality.bounces = bounces;
  view.seed = seed;
  return view;
}

}  // namespace cyclorama
