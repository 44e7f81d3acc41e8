// SPDX-License-Identifier: Apache-2.0
/// Where a node is.
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_json.h"

namespace cyclorama {

/// T_parent_node from `matrix` or from translation, rotation and scale. kBadData  both, or no affine transform.
Result<Eigen::Affine3d> read_node_transform(const GltfObject& node, GltfNotes* notes);

/// `rotation` is glTF's (x, y, z, w) of any length; nothing without a direction.
std::optional<Eigen::Affine3d> compose_transform(const Eigen::Vector3d& translation, const Eigen::Vector4d& rotation,
                                                 const Eigen::Vector3d& scale);

/// Finite, and not flattened so that it could not be undone: what a ray tracer needs of an instance.
bool is_invertible(const Eigen::Affine3d& transform);

}  // namespace cyclorama
