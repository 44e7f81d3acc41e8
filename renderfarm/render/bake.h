// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/scene/scene.h"

namespace cyclorama {

/// Where the render frame lies in the Scene frame: float is finest near its origin. The start eye if it is inside the
/// bounds, else the bounds' centre.
[[nodiscard]] Eigen::Vector3d render_origin(const Scene& scene);

/// How often each mesh of the model is used.
[[nodiscard]] std::vector<int> uses_of_meshes(const Model& model);

/// Moves `mesh` in place so that p_scene = `new_origin` + position: for meshes that are used once, which then need no
/// instance. Normals and tangents turn with it.
void bake(Mesh& mesh, const Eigen::Affine3d& T_scene_mesh, const Eigen::Vector3d& new_origin);

}  // namespace cyclorama
