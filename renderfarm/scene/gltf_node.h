// SPDX-License-Identifier: Apache-2.0
/// Flattens the scene graph into instances, lights and viewpoints.
#pragma once

#include <cstddef>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_document.h"
#include "renderfarm/scene/gltf_mesh.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Nodes as a forest, checked to be free of loops.
struct GltfForest {
  std::vector<std::vector<std::size_t>> children;
  std::vector<std::size_t> all_roots;    ///< Roots of the whole file.
  std::vector<std::size_t> shown_roots;  ///< Roots of the default scene, or of the whole file if it has no scenes.
};

/// Reads the forest. A node that the scene lists twice, or together with an ancestor, is shown once, with a note.
/// Errors: kBadData for a loop or a node with two parents.
Result<GltfForest> read_gltf_forest(const GltfDocument& document, GltfNotes* notes);

/// Fills the instances, lights and viewpoints of the model, and loads the meshes that they need through `meshes`. A
/// file with meshes but no nodes shows each mesh once.
Status show_gltf_scene(GltfDocument* document, GltfContext* context, GltfMeshes* meshes, Model* ret_model);

}  // namespace cyclorama::scene
