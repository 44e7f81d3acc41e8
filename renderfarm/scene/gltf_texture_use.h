// SPDX-License-Identifier: Apache-2.0
/// Readers of values that all kinds of glTF materials have.
#pragma once

#include <array>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_document.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Clips each component to [0, 1].
[[nodiscard]] Eigen::Vector4f unit_colour(const std::array<double, 4>& colour);

/// Reads `from`.`key` as a textureInfo with its KHR_texture_transform. The texture is a checked index into glTF's
/// textures; -1 if the key is absent.
Result<TextureUse> read_texture_use(const GltfDocument& document, const GltfObject& from, const char* key,
                                    GltfNotes* notes);

/// Returns `from`.`key`, or `fallback` if the key is absent. A value outside [0, max] is clipped, with a note.
Result<float> read_factor(const GltfObject& from, const char* key, double fallback, double max, GltfNotes* notes);

/// Returns the scale of the normal map `from`.`key`; 1 if absent.
Result<float> read_normal_scale(const GltfObject& from, const char* key);

}  // namespace cyclorama::scene
