// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

#include "common/wire/farm.pb.h"

namespace cyclorama {

/// Returns a scene whose walkable area is a square of 20 m.
inline wire::SceneDescription fake_scene(const std::string& name) {
  wire::SceneDescription scene;
  scene.set_name(name);
  scene.set_title("A plain room");
  scene.set_triangles_seen(12);
  scene.set_triangles_stored(12);
  scene.mutable_start_eye_m()->set_y(1.6);
  scene.set_eye_height_m(1.6);
  scene.set_walking_scale(1.0);
  for (const auto& [x, z] : {std::pair{-10.0, -10.0}, {10.0, -10.0}, {10.0, 10.0}, {-10.0, 10.0}}) {
    wire::GroundPoint* const corner = scene.add_walkable();
    corner->set_x_m(x);
    corner->set_z_m(z);
  }
  return scene;
}

}  // namespace cyclorama
