// SPDX-License-Identifier: Apache-2.0
/// EXT_mesh_gpu_instancing: one node that draws its mesh many times.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_document.h"

namespace cyclorama::scene {

/// Returns T_node_mesh of each copy. `extension` is the node's EXT_mesh_gpu_instancing object.
Result<std::vector<Eigen::Affine3d>> read_instancing(GltfDocument* document, const GltfObject& extension,
                                                     GltfContext* context);

}  // namespace cyclorama::scene
