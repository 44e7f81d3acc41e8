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

/// from.key, or `fallback`; clipped to [0, most] with a note.
Result<float> read_factor(const GltfObject& from, const char* key, double fallback, double most, GltfNotes* notes);

/// from.key.scale of a normal map; 1 where it is not given.
Result<float> read_normal_scale(const GltfObject& from, const char* key);

}  // namespace cyclorama
