// SPDX-License-Identifier: Apache-2.0
/// Reads the lights of KHR_lights_punctual.
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_document.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Returns the light of `node` in the model's frame; nothing if it has none. Lights of unknown kinds are noted.
Result<std::optional<Light>> read_node_light(const GltfDocument& document, const GltfObject& node,
                                             const Eigen::Affine3d& T_model_node, GltfNotes* notes);

}  // namespace cyclorama::scene
