// SPDX-License-Identifier: Apache-2.0
/// import_gltf() of model.h, for bytes that are in memory already.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>

#include "common/base/result.h"
#include "renderfarm/scene/model.h"

namespace cyclorama {

/// As import_gltf(); errors name the place and not the file. `folder` is where the files are that the scene refers to;
/// without it, a scene that refers to any is refused. Reentrant.
Result<Model> import_gltf_bytes(std::span<const std::byte> bytes, const std::optional<std::filesystem::path>& folder,
                                const ImportLimits& limits);

}  // namespace cyclorama
