// SPDX-License-Identifier: Apache-2.0
/// Morph targets, applied with the default weights of their mesh. Source: glTF 2.0, section 3.7.2.2.
#pragma once

#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_accessor.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_document.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Returns the `weights` of a mesh; empty if the mesh has none, which means that all are zero.
Result<std::vector<double>> read_morph_weights(const GltfObject& mesh);

/// Adds the targets of `primitive` whose weights are not zero to the positions and normals of `mesh`, which holds the
/// selected vertices. Errors: kBadData if a target's accessors do not fit the primitive, or the budget is exceeded.
Status apply_morphs(GltfDocument* document, const GltfObject& primitive, const std::vector<double>& weights,
                    std::size_t vertex_count, const GltfSelection& selection, GltfContext* context, Mesh* mesh);

}  // namespace cyclorama::scene
