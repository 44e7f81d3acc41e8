// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/extremes/extreme_shapes.h"

#include <numbers>
#include <utility>

namespace cyclorama {
namespace {

std::array<float, 3> to_floats(const Eigen::Vector3d& p) {
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
}

}  // namespace

scene::Material plain_material(const Eigen::Vector3f& albedo) {
  scene::Material material;
  material.base_colour << albedo, 1.0f;
  material.metallic = 0.0f;
  return material;
}

scene::Mesh ball(double radius, int rings, bool smooth) {
  scene::Mesh mesh;
  const int around = 2 * rings;
  const auto add = [&](double polar, double azimuth) {
    const Eigen::Vector3d out(std::sin(polar) * std::sin(azimuth), std::cos(polar),
                              std::sin(polar) * std::cos(azimuth));
    mesh.positions.push_back(to_floats(radius * out));
    if (smooth) mesh.normals.push_back(to_floats(out));
  };
  add(0.0, 0.0);
  for (int ring = 1; ring < rings; ++ring) {
    for (int i = 0; i < around; ++i) {
      add(std::numbers::pi * ring / rings, 2.0 * std::numbers::pi * i / around);
    }
  }
  add(std::numbers::pi, 0.0);
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  const auto vertex = [&](int ring, int i) {
    if (ring == 0) return std::uint32_t{0};
    return ring == rings ? last : static_cast<std::uint32_t>(1 + (ring - 1) * around + i % around);
  };
  for (int ring = 0; ring < rings; ++ring) {
    for (int i = 0; i < around; ++i) {
      const std::uint32_t a = vertex(ring, i), b = vertex(ring + 1, i);
      const std::uint32_t c = vertex(ring + 1, i + 1), d = vertex(ring, i + 1);
      if (ring > 0) mesh.triangles.push_back({a, b, d});
      if (ring + 1 < rings) mesh.triangles.push_back({d, b, c});
    }
  }
  return mesh;
}

scene::Mesh block(const Eigen::Vector3d& size) {
  scene::Mesh mesh;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d side((corner & 1) != 0 ? 0.5 : -0.5, (corner & 2) != 0 ? 0.5 : -0.5,
                               (corner & 4) != 0 ? 0.5 : -0.5);
    mesh.positions.push_back(to_floats(side.cwiseProduct(size)));
  }
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return mesh;
}

scene::Mesh square(double size, float repeats) {
  const auto h = static_cast<float>(0.5 * size);
  scene::Mesh mesh;
  mesh.positions = {{-h, 0, -h}, {h, 0, -h}, {h, 0, h}, {-h, 0, h}};
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  mesh.texcoords[0] = {{0, 0}, {repeats, 0}, {repeats, repeats}, {0, repeats}};
  return mesh;
}

void put(scene::Scene& scene, scene::Mesh mesh, const scene::Material& material, const Eigen::Affine3d& T_scene_mesh) {
  mesh.material = static_cast<int>(scene.model.materials.size());
  scene.model.materials.push_back(material);
  for (const auto& p : mesh.positions) {
    scene.bounds.extend(T_scene_mesh * (mesh.origin + Eigen::Vector3f(p[0], p[1], p[2]).cast<double>()));
  }
  scene.model.instances.push_back({static_cast<int>(scene.model.meshes.size()), T_scene_mesh});
  scene.model.meshes.push_back(std::move(mesh));
}

scene::Light lamp_at(const Eigen::Vector3d& position, float candela, double radius_m) {
  scene::Light light;
  light.position = position;
  light.intensity.setConstant(candela);
  light.radius_m = radius_m;
  light.visible = radius_m > 0.0;
  return light;
}

scene::Light panel_at(const Eigen::Vector3d& position, const Eigen::Vector3d& direction, double size_m,
                      float radiance) {
  scene::Light light;
  light.kind = scene::LightKind::kRectangle;
  light.position = position;
  light.direction = direction.normalized();
  light.across = light.direction.unitOrthogonal();
  light.size_m.setConstant(size_m);
  light.intensity.setConstant(radiance);
  light.visible = true;
  return light;
}

scene::Sky even_sky(float radiance) {
  const Eigen::Vector3f light = Eigen::Vector3f::Constant(radiance);
  return {light, light, light};
}

scene::Scene open_ground() {
  scene::Scene scene;
  put(scene, square(10.0), plain_material());
  put(scene, ball(0.5, 12, true), plain_material({0.7f, 0.4f, 0.3f}),
      Eigen::Affine3d(Eigen::Translation3d(0.0, 0.5, -1.0)));
  scene.sky = even_sky(0.3f);
  scene.info.start_eye = {0.0, 1.0, 2.0};
  return scene;
}

render::PanoramaView view_around(const Eigen::Vector3d& eye) {
  render::PanoramaView view;
  view.eye = eye;
  view.panorama = {64, 32, 2.0 * std::numbers::pi, 1.5, -1.5};
  view.quality.samples = 8;
  view.quality.bounces = 4;
  return view;
}

}  // namespace cyclorama
