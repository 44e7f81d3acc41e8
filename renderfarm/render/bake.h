// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/scene/scene.h"

namespace cyclorama::render {

/// Returns the origin of the render frame in the Scene frame, near which float is most precise: the start eye if it is
/// inside the bounds, else the centre of the bounds.
[[nodiscard]] Eigen::Vector3d render_origin(const scene::Scene& scene);

/// Returns the number of instances of each mesh of the model.
[[nodiscard]] std::vector<int> uses_of_meshes(const scene::Model& model);

/// Moves `mesh` in place so that p_scene = `new_origin` + position; a mesh that is used once then needs no instance.
/// Normals and tangents are transformed as well.
void bake(scene::Mesh& mesh, const Eigen::Affine3d& T_scene_mesh, const Eigen::Vector3d& new_origin);

}  // namespace cyclorama::render
