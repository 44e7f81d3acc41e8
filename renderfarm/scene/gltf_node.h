// SPDX-License-Identifier: Apache-2.0
/// The scene graph, flattened: every mesh that the scene shows as an instance, and its lights.
#pragma once

#include <cstddef>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_document.h"
#include "renderfarm/scene/gltf_mesh.h"
#include "renderfarm/scene/model.h"

namespace cyclorama {

/// Nodes as a forest: checked, so that walking it ends.
struct GltfForest {
  std::vector<std::vector<std::size_t>> children;
  std::vector<std::size_t> shown_roots;  ///< Of the default scene; of the whole file, where it has no scenes.
};

/// kBadData  a loop, a node with two parents, or a scene that names a node which is not a root.
Result<GltfForest> read_gltf_forest(const GltfDocument& document);

/// Fills instances, lights and viewpoints, and through `meshes` all that they need. A file of meshes without any node
/// shows each mesh once.
Status show_gltf_scene(GltfDocument* document, GltfContext* context, GltfMeshes* meshes, Model* ret_model);

}  // namespace cyclorama
