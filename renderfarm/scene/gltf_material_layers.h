// SPDX-License-Identifier: Apache-2.0
/// Material extensions for index of refraction, specular strength, clearcoat, transmission and volume.
#pragma once

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_document.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Reads KHR_materials_ior, _specular, _clearcoat, _transmission and _volume of the material `object`. Each TextureUse
/// contains a checked index into glTF's textures.
Status read_material_layers(const GltfDocument& document, const GltfObject& object, GltfNotes* notes,
                            Material* ret_material);

}  // namespace cyclorama::scene
