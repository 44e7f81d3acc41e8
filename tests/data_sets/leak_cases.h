// SPDX-License-Identifier: Apache-2.0
/// Scenes in which stored light might leak: bright beside dark, with thin things between.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tests/data_sets/light_scenes.h"

namespace cyclorama {

struct LeakCase {
  std::string name;
  scene::Scene scene;
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();
};

/// Places a square of side 1 with its middle at `middle`, scaled to `width` by `height`, upright, across the z axis.
inline void add_upright(scene::Scene& scene, const Eigen::Vector3d& middle, double width, double height) {
  add_mesh(scene, square_mesh(1.0f),
           Eigen::Translation3d(middle) * Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitX()) *
               Eigen::Scaling(width, 1.0, height));
}

/// The same across the x axis; `height` counts upwards and `width` along z.
inline void add_upright_along_z(scene::Scene& scene, const Eigen::Vector3d& middle, double width, double height) {
  add_mesh(scene, square_mesh(1.0f),
           Eigen::Translation3d(middle) * Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitZ()) *
               Eigen::Scaling(height, 1.0, width));
}

inline void add_level(scene::Scene& scene, const Eigen::Vector3d& middle, double along_x, double along_z) {
  add_mesh(scene, square_mesh(1.0f), Eigen::Translation3d(middle) * Eigen::Scaling(along_x, 1.0, along_z));
}

/// A room of 4 m with a lamp of a hand's width.
inline scene::Scene room_with_lamp(int parts, const Eigen::Vector3d& lamp, float candela) {
  scene::Scene scene = box_scene(0.5f, parts);
  scene.model.lights = {point_light(lamp, candela)};
  scene.model.lights[0].radius_m = 0.1;
  scene.exposure = 0.5;
  return scene;
}

/// Returns all cases; `parts` is the number of squares along an edge of the rooms.
inline std::vector<LeakCase> leak_cases(int parts) {
  std::vector<LeakCase> cases;
  const auto add = [&](std::string name, scene::Scene scene, const Eigen::Vector3d& eye) {
    scene.info.start_eye = eye;
    cases.push_back({std::move(name), std::move(scene), eye});
  };
  {
    // A lamp in a closed box of no thickness that stands in a dim room.
    scene::Scene scene = room_with_lamp(parts, {1.0, -1.5, 0.1}, 60.0f);
    for (const double side : {-0.45, 0.45}) {
      add_upright(scene, {1.0, -1.5, 0.1 + side}, 0.9, 1.2);
      add_upright_along_z(scene, {1.0 + side, -1.5, 0.1}, 0.9, 1.2);
    }
    add_level(scene, {1.0, -0.9, 0.1}, 0.9, 0.9);
    scene.model.lights.push_back(point_light({-1.4, 1.4, -1.2}, 1.0f));
    scene.model.lights[1].radius_m = 0.1;
    add("a closed box", std::move(scene), {-0.7, 0.2, 0.3});
  }
  {
    scene::Scene scene = room_with_lamp(parts, {1.2, 0.5, 0.3}, 20.0f);
    add_upright_along_z(scene, {0.37, 0.0, 0.0}, 4.0, 4.0);
    add("a thin wall between bright and dark", std::move(scene), {-1.0, 0.2, 0.1});
  }
  {
    // It hangs 3 cm above the floor.
    scene::Scene scene = room_with_lamp(parts, {1.2, 0.8, 0.3}, 20.0f);
    add_upright_along_z(scene, {0.37, 0.015, 0.0}, 4.0, 3.97);
    add("a curtain", std::move(scene), {-1.0, 0.2, 0.1});
  }
  {
    scene::Scene scene = room_with_lamp(parts, {1.3, 0.4, 1.2}, 20.0f);
    add_upright_along_z(scene, {0.2, 0.0, 0.9}, 2.2, 4.0);
    add("a corner to look around", std::move(scene), {-0.9, 0.2, 0.4});
  }
  {
    scene::Scene scene = room_with_lamp(parts, {0.9, 1.3, 0.9}, 20.0f);
    // A ledge on the wall, open in front.
    for (const double side : {-0.4, 0.4}) {
      add_upright_along_z(scene, {side, 0.0, -1.8}, 0.4, 0.8);
      add_level(scene, {0.0, side, -1.8}, 0.8, 0.4);
    }
    add("a niche", std::move(scene), {0.2, 0.2, 0.3});
  }
  {
    scene::Scene scene = room_with_lamp(parts, {0.5, -1.45, -0.6}, 6.0f);
    scene.model.lights[0].radius_m = 0.04;
    for (int i = 0; i < 8; ++i) {
      const double angle = 0.25 * std::numbers::pi * i;
      const Eigen::Vector3d outward(std::cos(angle), 0.0, std::sin(angle));
      Eigen::Matrix3d axes;
      const Eigen::Vector3d up = (outward + Eigen::Vector3d::UnitY()).normalized();
      const Eigen::Vector3d across = up.cross(outward).normalized();
      axes << across, across.cross(up).normalized(), up;
      add_mesh(scene, square_mesh(0.28f),
               Eigen::Translation3d(Eigen::Vector3d(0.5, -1.5, -0.6) + 0.24 * outward) * Eigen::Affine3d(axes));
    }
    add("a lamp in a bowl", std::move(scene), {-0.6, 0.2, 0.5});
  }
  {
    // The sun through a slit of 6 cm in a second ceiling below the first, which is taken away.
    scene::Scene scene = room_with_lamp(parts, {0.0, 0.0, 0.0}, 0.0f);
    scene.model.instances.erase(scene.model.instances.begin() + 3);  // The box's top.
    add_level(scene, {-1.03, 1.99, 0.0}, 2.0, 4.1);
    add_level(scene, {1.03, 1.99, 0.0}, 2.0, 4.1);
    scene.model.lights[0].kind = scene::LightKind::kDirectional;
    scene.model.lights[0].direction = Eigen::Vector3d(0.3, -1.0, 0.1).normalized();
    scene.model.lights[0].intensity = Eigen::Vector3f::Constant(8.0f);
    scene.model.lights[0].radius_m = 0.00465;
    add("a letter-box slit of sun", std::move(scene), {-0.6, 0.2, 0.5});
  }
  {
    // A floor of two triangles, 100 m wide, under balls of millimetres.
    scene::Scene scene;
    scene.model.materials.push_back(matte_material(Eigen::Vector3f::Constant(0.5f)));
    scene::Mesh floor = square_mesh(100.0f);
    add_mesh(scene, std::move(floor), Eigen::Affine3d(Eigen::Translation3d(0.0, -1.0, 0.0)));
    scene::Mesh ball = sphere_mesh(0.2f, 200);
    ball.origin = {0.1, -0.8, -0.8};
    add_mesh(scene, std::move(ball));
    scene.model.lights = {point_light({0.7, 0.8, -0.3}, 4.0f)};
    scene.model.lights[0].radius_m = 0.1;
    scene.exposure = 0.5;
    add("a triangle of 100 m beside ones of 1 mm", std::move(scene), {-0.2, 0.1, 0.3});
  }
  for (const auto& [name, height] :
       {std::pair{"a concave wavy floor", &bowl}, std::pair{"a convex wavy floor", &waves}}) {
    scene::Scene scene = lit_floor(1, 2 * parts, height);
    const Eigen::Vector3d eye = scene.info.start_eye;
    add(name, std::move(scene), eye);
  }
  return cases;
}

}  // namespace cyclorama
