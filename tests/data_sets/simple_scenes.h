// SPDX-License-Identifier: Apache-2.0
/// Scenes whose pictures can be computed by hand.
#pragma once

#include <cmath>
#include <numbers>
#include <utility>

#include "renderfarm/render/renderer.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama {

/// A matte material of one linear colour.
inline scene::Material matte_material(const Eigen::Vector3f& albedo) {
  scene::Material material;
  material.base_colour << albedo, 1.0f;
  material.metallic = 0.0f;
  material.roughness = 1.0f;
  return material;
}

/// A square of side `size` about the origin, in the plane y = 0, its uv (0, 0) at -x, -z.
inline scene::Mesh square_mesh(float size, int material = 0) {
  const float h = 0.5f * size;
  scene::Mesh mesh;
  mesh.positions = {{-h, 0, -h}, {h, 0, -h}, {h, 0, h}, {-h, 0, h}};
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  mesh.texcoords[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.material = material;
  return mesh;
}

/// A sphere about the origin without normals (flat faces), with `rings` from pole to pole. Closed.
inline scene::Mesh sphere_mesh(float radius, int rings, int material = 0) {
  scene::Mesh mesh;
  const int around = 2 * rings;
  mesh.positions.push_back({0, radius, 0});
  for (int i = 1; i < rings; ++i) {
    const double polar = std::numbers::pi * i / rings;
    for (int j = 0; j < around; ++j) {
      const double azimuth = 2.0 * std::numbers::pi * j / around;
      mesh.positions.push_back({radius * static_cast<float>(std::sin(polar) * std::sin(azimuth)),
                                radius * static_cast<float>(std::cos(polar)),
                                radius * static_cast<float>(std::sin(polar) * std::cos(azimuth))});
    }
  }
  mesh.positions.push_back({0, -radius, 0});
  const auto vertex = [&](int ring, int j) -> std::uint32_t {
    if (ring == 0) return 0;
    if (ring == rings) return static_cast<std::uint32_t>(mesh.positions.size() - 1);
    return static_cast<std::uint32_t>(1 + (ring - 1) * around + j % around);
  };
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < around; ++j) {
      if (i > 0) mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)});
      if (i + 1 < rings) mesh.triangles.push_back({vertex(i, j + 1), vertex(i + 1, j), vertex(i + 1, j + 1)});
    }
  }
  mesh.material = material;
  return mesh;
}

inline void add_mesh(scene::Scene& scene, scene::Mesh mesh,
                     const Eigen::Affine3d& T_scene_mesh = Eigen::Affine3d::Identity()) {
  for (const auto& p : mesh.positions) {
    scene.bounds.extend(T_scene_mesh * (mesh.origin + Eigen::Vector3d(p[0], p[1], p[2])));
  }
  scene.model.instances.push_back({static_cast<int>(scene.model.meshes.size()), T_scene_mesh});
  scene.model.meshes.push_back(std::move(mesh));
}

/// A scene of one mesh in matte grey, without light.
inline scene::Scene scene_of(scene::Mesh mesh, const Eigen::Vector3f& albedo = Eigen::Vector3f::Constant(0.5f)) {
  scene::Scene scene;
  scene.model.materials.push_back(matte_material(albedo));
  add_mesh(scene, std::move(mesh));
  return scene;
}

inline scene::Light point_light(const Eigen::Vector3d& position, float candela) {
  scene::Light light;
  light.position = position;
  light.intensity = Eigen::Vector3f::Constant(candela);
  return light;
}

/// A view of a full circle, from `top` to `bottom` in tangents of elevation.
inline render::PanoramaView view_from(const Eigen::Vector3d& eye, int width, int height, double top, double bottom) {
  render::PanoramaView view;
  view.eye = eye;
  view.panorama = {width, height, 2.0 * std::numbers::pi, top, bottom};
  return view;
}

inline PixelRect whole(const render::PanoramaView& view) {
  return {0, 0, view.panorama.width_px, view.panorama.height_px};
}

/// Returns the linear radiance of the whole view.
inline RadianceImage radiance_of(const render::Renderer& renderer, const render::PanoramaView& view) {
  RadianceImage image;
  renderer.render_radiance(view, whole(view), &image, nullptr);
  return image;
}

inline double mean_of(const RadianceImage& image) {
  double sum = 0.0;
  for (const float value : image.data()) sum += static_cast<double>(value);
  return sum / static_cast<double>(image.data().size());
}

}  // namespace cyclorama
