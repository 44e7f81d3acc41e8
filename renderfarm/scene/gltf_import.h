// SPDX-License-Identifier: Apache-2.0
/// The counterpart of import_gltf() (model.h) for bytes in memory.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>

#include "common/base/result.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Imports glTF like import_gltf(), but errors name the place in the JSON and not the file. Files to which the scene
/// refers are read from `folder`; without it, a scene that refers to files is refused. Reentrant.
Result<Model> import_gltf_bytes(std::span<const std::byte> bytes, const std::optional<std::filesystem::path>& folder,
                                const ImportLimits& limits);

}  // namespace cyclorama::scene
