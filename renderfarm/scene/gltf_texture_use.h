// SPDX-License-Identifier: Apache-2.0
/// Parts that all kinds of glTF materials share.
#pragma once

#include <array>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_document.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Clips each component to [0, 1].
[[nodiscard]] Eigen::Vector4f unit_colour(const std::array<double, 4>& colour);

/// Reads from.key as a textureInfo with its KHR_texture_transform. The texture is a checked glTF index; -1 if absent.
Result<TextureUse> read_texture_use(const GltfDocument& document, const GltfObject& from, const char* key,
                                    GltfNotes* notes);

/// Returns from.key, or `fallback` if absent, clipped to [0, max] with a note.
Result<float> read_factor(const GltfObject& from, const char* key, double fallback, double max, GltfNotes* notes);

/// Returns from.key.scale of a normal map; 1 if absent.
Result<float> read_normal_scale(const GltfObject& from, const char* key);

}  // namespace cyclorama::scene
