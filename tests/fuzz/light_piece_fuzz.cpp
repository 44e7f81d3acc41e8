// SPDX-License-Identifier: Apache-2.0
/// Pieces of light that come from other nodes: grids that are accepted have the samples that their parts say, and are
/// written as they were read.
#include <cstddef>
#include <cstdint>

#include "common/base/check.h"
#include "renderfarm/light/light_store.h"
#include "renderfarm/light_baking/grid_pieces.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  using namespace cyclorama::light_baking;
  constexpr std::size_t kTriangles = 1000;
  const std::span bytes = std::as_bytes(std::span(data, size));
  PieceReader in(bytes);
  if (const auto grid = read_grid_in_work(&in, kTriangles); grid && in.finished()) {
    CHECK(grid->triangle < kTriangles && grid->rough.size() == grid->light.size());
    PieceWriter out;
    add(*grid, &out);
    CHECK(out.take().size() == size);
  }
  PieceReader made_in(bytes);
  if (const auto grid = read_made_grid(&made_in, kTriangles); grid && made_in.finished()) {
    const auto samples = static_cast<std::size_t>(light::TriangleGrid::samples(grid->parts));
    CHECK(grid->light.size() == samples && grid->separate.size() == samples);
  }
  return 0;
}
