// SPDX-License-Identifier: Apache-2.0
/// Gaussian splats in the format of the original program: rows of a PLY file.
#pragma once

#include <cstddef>
#include <span>

#include "common/base/result.h"
#include "renderfarm/scene/model.h"
#include "renderfarm/scene/ply_header.h"

namespace cyclorama::scene {

[[nodiscard]] bool holds_splats(const PlyHeader& header);

/// Reads splats. In the original program, y points down as in the frame of its first camera; the result is rotated so
/// that y points up. Precondition: holds_splats(). Errors: kBadData, with the row.
Result<Model> read_splat_ply(std::span<const std::byte> file, const PlyHeader& header, const ImportLimits& limits);

}  // namespace cyclorama::scene
