// SPDX-License-Identifier: Apache-2.0
/// Checks the extensions that a glTF file uses against those that are supported.
#pragma once

#include <set>
#include <string>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_json.h"

namespace cyclorama::scene {

/// Returns the names in extensionsUsed and notes each unsupported one once. Errors: kBadData if an unsupported
/// extension is required and the picture would be wrong without it, not just slightly different.
Result<std::set<std::string, std::less<>>> check_gltf_extensions(const GltfObject& root, GltfNotes* notes);

}  // namespace cyclorama::scene
