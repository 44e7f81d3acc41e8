// SPDX-License-Identifier: Apache-2.0
/// What to do about the extensions that a glTF file says it uses.
#pragma once

#include <set>
#include <string>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_json.h"

namespace cyclorama {

/// The names in extensionsUsed. Each one that we lack is noted once; one that is required, and without which the
/// picture would not just look a little different but be wrong, is kBadData.
Result<std::set<std::string, std::less<>>> check_gltf_extensions(const GltfObject& root, GltfNotes* notes);

}  // namespace cyclorama
