// SPDX-License-Identifier: Apache-2.0
/// The extensions that give a glTF material a stronger or weaker gloss, a coat above it and a body below.
#pragma once

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_document.h"
#include "renderfarm/scene/model.h"

namespace cyclorama {

/// KHR_materials_ior, _specular, _clearcoat, _transmission and _volume of the material `object`. Each TextureUse holds
/// glTF's texture index, checked.
Status read_material_layers(const GltfDocument& document, const GltfObject& object, GltfNotes* notes,
                            Material* ret_material);

}  // namespace cyclorama
