// SPDX-License-Identifier: Apache-2.0
/// KHR_gaussian_splatting, with data in SPZ or in accessors.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_document.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Returns true if the points of a primitive are splats.
Result<bool> is_gltf_splats(const GltfObject& primitive);

/// Adds the splats of a mesh, placed by `T_model_mesh`, to the model. Errors: kBadData if they are damaged or exceed
/// the budget. Precondition: `mesh` came from GltfDocument::index().
Status add_gltf_splats(GltfDocument* document, GltfContext* context, std::size_t mesh,
                       const Eigen::Affine3d& T_model_mesh, Model* ret_model);

}  // namespace cyclorama::scene
