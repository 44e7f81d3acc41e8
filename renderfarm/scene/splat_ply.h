// SPDX-License-Identifier: Apache-2.0
/// Gaussian splats as the original program writes them: rows of a PLY file.
#pragma once

#include <cstddef>
#include <span>

#include "common/base/result.h"
#include "renderfarm/scene/model.h"
#include "renderfarm/scene/ply_header.h"

namespace cyclorama::scene {

[[nodiscard]] bool holds_splats(const PlyHeader& header);

/// Reads the splats of a file for which holds_splats(). The original program trains in the frame of its first camera, in
/// which y points down; they are turned so that y points up. Errors: kBadData, with the row.
Result<Model> read_splat_ply(std::span<const std::byte> file, const PlyHeader& header, const ImportLimits& limits);

}  // namespace cyclorama::scene
