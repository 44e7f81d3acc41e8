// SPDX-License-Identifier: Apache-2.0
/// The small parts that every kind of glTF material is made of.
#pragma once

#include <array>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_document.h"
#include "renderfarm/scene/model.h"

namespace cyclorama {

/// Clipped to [0, 1].
[[nodiscard]] Eigen::Vector4f unit_colour(const std::array<double, 4>& colour);

/// from.key as a textureInfo with its KHR_texture_transform. The texture is glTF's index, checked; -1 when absent.
Result<TextureUse> read_texture_use(const GltfDocument& document, const GltfObject& from, const char* key,
                                    GltfNotes* notes);

}  // namespace cyclorama
