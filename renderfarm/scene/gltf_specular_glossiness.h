// SPDX-License-Identifier: Apache-2.0
/// Converts KHR_materials_pbrSpecularGlossiness, common in older scans, to metallic-roughness.
#pragma once

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_document.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Replaces the metallic-roughness part of `ret_material` by the converted factors. The texture of specular colour and
/// glossiness is left out, with a note.
Status read_specular_glossiness(const GltfDocument& document, const GltfObject& extension, GltfNotes* notes,
                                Material* ret_material);

}  // namespace cyclorama::scene
