// SPDX-License-Identifier: Apache-2.0
/// Skins in their rest pose, which the transforms of the file's nodes define. Source: glTF 2.0, section 3.7.3.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_accessor.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_document.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// The joints that move each vertex of a Mesh, and their weights, which sum to 1.
struct GltfSkinning {
  std::vector<std::array<std::uint16_t, 4>> joints;
  std::vector<std::array<float, 4>> weights;
};

/// Converts JOINTS_0 and WEIGHTS_0 of the selected vertices; a vertex without weights follows its first joint.
/// Precondition: the formats of both accessors have been checked. Errors: kBadData if the budget is exceeded.
Result<GltfSkinning> read_skinning(const GltfAccessor& joints, const GltfAccessor& weights,
                                   const GltfSelection& selection, GltfBudget* budget);

/// Returns, for each joint of `skin`, its transform times its inverse bind matrix, which leads from the stored mesh to
/// the model. `T_model_node` has one entry per node. Errors: kBadData if a reference of the skin is invalid or its
/// matrices are not transforms.
Result<std::vector<Eigen::Affine3d>> read_pose(GltfDocument* document, const GltfObject& skin,
                                               const std::vector<Eigen::Affine3d>& T_model_node, GltfBudget* budget);

/// Moves the positions, normals and tangents of `mesh`. Errors: kBadData, with `place`, if a vertex follows a joint
/// that the skin lacks.
Status apply_pose(const GltfSkinning& skinning, const std::vector<Eigen::Affine3d>& pose, const std::string& place,
                  Mesh* mesh);

}  // namespace cyclorama::scene
