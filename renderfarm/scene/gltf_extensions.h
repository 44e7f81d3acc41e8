// SPDX-License-Identifier: Apache-2.0
/// Checks the extensions that a glTF file uses against those that are supported.
#pragma once

#include <set>
#include <string>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_json.h"

namespace cyclorama::scene {

/// Returns the names in extensionsUsed and notes each unsupported extension once. Errors: kBadData, with the
/// extension's name, if the file requires an unsupported extension, without which its author considers it unusable.
Result<std::set<std::string, std::less<>>> check_gltf_extensions(const GltfObject& root, GltfNotes* notes);

}  // namespace cyclorama::scene
