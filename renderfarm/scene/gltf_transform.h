// SPDX-License-Identifier: Apache-2.0
/// Transforms of nodes.
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_json.h"

namespace cyclorama::scene {

/// Reads T_parent_node from `matrix` or from translation, rotation and scale. Errors: kBadData if both are given or the
/// transform is not affine.
Result<Eigen::Affine3d> read_node_transform(const GltfObject& node, GltfNotes* notes);

/// Returns the transform that scales, rotates and then translates; nothing if `rotation` is zero. `rotation` is glTF's
/// quaternion (x, y, z, w), of any length.
std::optional<Eigen::Affine3d> compose_transform(const Eigen::Vector3d& translation, const Eigen::Vector4d& rotation,
                                                 const Eigen::Vector3d& scale);

/// Returns true if the transform is finite and can be inverted, which a ray tracer requires of an instance.
bool is_invertible(const Eigen::Affine3d& transform);

}  // namespace cyclorama::scene
