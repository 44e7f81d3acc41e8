// SPDX-License-Identifier: Apache-2.0
/// A small room with every kind of light transport.
#pragma once

#include "tests/data_sets/simple_scenes.h"

namespace cyclorama {

inline scene::Material white_material(float roughness, float metallic) {
  scene::Material material;
  material.roughness = roughness;
  material.metallic = metallic;
  return material;
}

/// A room with a lamp of each kind, and surfaces of each level.
inline scene::Scene mixed_room(float scale = 1.0f) {
  scene::Scene scene = scene_of(sphere_mesh(3.0f, 12), {0.7f, 0.6f, 0.5f});
  scene.model.materials.push_back(white_material(0.3f, 1.0f));
  scene.model.materials.push_back(white_material(0.0f, 0.0f));
  scene.model.materials[2].transmission = 1.0f;
  scene.model.materials[2].thickness = 1.0f;
  scene.model.materials.push_back(matte_material({0.2f, 0.2f, 0.2f}));
  scene.model.materials[3].emissive.setConstant(4.0f * scale);
  add_mesh(scene, sphere_mesh(0.6f, 8, 1), Eigen::Affine3d(Eigen::Translation3d(0.9, -0.6, -1.6)));
  add_mesh(scene, sphere_mesh(0.5f, 8, 2), Eigen::Affine3d(Eigen::Translation3d(-0.8, -0.5, -1.4)));
  add_mesh(scene, square_mesh(0.5f, 3), Eigen::Affine3d(Eigen::Translation3d(0.0, -1.2, -1.0)));
  scene::Light rectangle;
  rectangle.kind = scene::LightKind::kRectangle;
  rectangle.position = {0.0, 1.8, -0.5};
  rectangle.size_m = {1.0, 0.6};
  rectangle.intensity.setConstant(5.0f * scale);
  rectangle.visible = true;
  scene.model.lights = {rectangle, point_light({0.5, 0.5, 0.8}, 1.5f * scale)};
  return scene;
}

inline render::PanoramaView room_view(int bounces, int samples) {
  render::PanoramaView view = view_from({0, 0, 0.5}, 16, 12, 0.8, -0.8);
  view.panorama.azimuth_span_rad = 2.0;
  view.quality.bounces = bounces;
  view.quality.samples = samples;
  return view;
}

}  // namespace cyclorama
