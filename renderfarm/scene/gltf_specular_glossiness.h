// SPDX-License-Identifier: Apache-2.0
/// KHR_materials_pbrSpecularGlossiness, which scans of the last decade have, as metallic-roughness.
#pragma once

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_document.h"
#include "renderfarm/scene/model.h"

namespace cyclorama {

/// Replaces the metallic-roughness part of `material`. Factors are converted; the texture of specular colour and
/// glossiness is left out with a note.
Status read_specular_glossiness(const GltfDocument& document, const GltfObject& extension, GltfNotes* notes,
                                Material* ret_material);

}  // namespace cyclorama
