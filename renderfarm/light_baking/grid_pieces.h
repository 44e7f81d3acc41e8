// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/light_baking/piece_bytes.h"
#include "renderfarm/light_baking/triangle_grids.h"

namespace cyclorama::light_baking {

/// Lower bound of the bytes that a grid takes in a piece.
inline constexpr std::size_t kMinGridBytes = 32;

void add(const GridInWork& grid, PieceWriter* to);
void add(const MadeGrid& grid, PieceWriter* to);

// The following functions check that a grid has the form that its users rely on. `triangles` is the number of triangles
// of its mesh. Errors: kBadData.

Result<GridInWork> read_grid_in_work(PieceReader* from, std::size_t triangles);
Result<MadeGrid> read_made_grid(PieceReader* from, std::size_t triangles);

}  // namespace cyclorama::light_baking
