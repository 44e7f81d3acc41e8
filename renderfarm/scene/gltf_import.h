// SPDX-License-Identifier: Apache-2.0
/// import_gltf() of model.h for bytes in memory.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>

#include "common/base/result.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Same contract as import_gltf(), but errors name the place and not the file. Files that the scene refers to are read
/// from `folder`; without it, such a scene is refused. Reentrant.
Result<Model> import_gltf_bytes(std::span<const std::byte> bytes, const std::optional<std::filesystem::path>& folder,
                                const ImportLimits& limits);

}  // namespace cyclorama::scene
