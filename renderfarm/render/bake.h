// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/scene/scene.h"

namespace cyclorama::render {

/// Returns the origin of the render frame, in the Scene frame: the start eye if it is inside the bounds, else the
/// centre of the bounds. Float is most precise near the origin.
[[nodiscard]] Eigen::Vector3d render_origin(const scene::Scene& scene);

/// Returns the number of instances of each mesh of the model.
[[nodiscard]] std::vector<int> uses_of_meshes(const scene::Model& model);

/// Transforms `mesh` in place, with its normals and tangents, so that p_scene = `new_origin` + position. A mesh that is
/// used once then needs no instance.
void bake(scene::Mesh& mesh, const Eigen::Affine3d& T_scene_mesh, const Eigen::Vector3d& new_origin);

}  // namespace cyclorama::render
