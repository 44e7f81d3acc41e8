// SPDX-License-Identifier: Apache-2.0
/// Settings for geometry that says nothing about its visitors: found by looking at it.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "renderfarm/scene/scene.h"

namespace cyclorama {

struct FoundSettings {
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();
  double heading_rad = 0.0;
  double eye_height_m = 1.6;
  double walking_scale = 1.0;
  std::vector<Eigen::Vector2d> walkable;
};

/// Precondition: `bounds` is bounds_of(model), not empty. In metres, y up. Reentrant.
[[nodiscard]] FoundSettings find_settings(const Model& model, const Eigen::AlignedBox3d& bounds);

/// Light for a scene that has none at all.
void add_light(const FoundSettings& found, Scene* scene);

}  // namespace cyclorama
