// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/balance/tiles.h"

#include <gtest/gtest.h>

#include <set>

namespace cyclorama::balance {
namespace {

TEST(Tiles, cover_the_block_exactly_on_the_grid_and_are_small) {
  for (const PixelRect block :
       {PixelRect{0, 0, 1, 1}, PixelRect{16, 32, 256, 256}, PixelRect{16, 32, 272, 257}, PixelRect{1024, 0, 1000, 999},
        PixelRect{0, 0, 16384, 17}, PixelRect{48, 16, 15, 4096}}) {
    std::int64_t area = 0;
    std::set<std::pair<int, int>> corners;
    for (const PixelRect& tile : tiles_of(block)) {
      EXPECT_FALSE(tile.empty());
      EXPECT_LE(tile.width, kMaxTilePx);
      EXPECT_LE(tile.height, kMaxTilePx);
      EXPECT_EQ((tile.x - block.x) % kCutPx, 0);
      EXPECT_EQ((tile.y - block.y) % kCutPx, 0);
      EXPECT_LE(tile.x + tile.width, block.x + block.width);
      EXPECT_LE(tile.y + tile.height, block.y + block.height);
      EXPECT_TRUE(corners.emplace(tile.x, tile.y).second);
      area += tile.area();
    }
    EXPECT_EQ(area, block.area());  // Distinct corners of a product grid: there is no overlap.
  }
}

TEST(Tiles, of_a_single_tile_are_that_tile) {
  for (const PixelRect& tile : tiles_of({32, 64, 1000, 700})) EXPECT_EQ(tiles_of(tile), std::vector{tile});
}

TEST(Tiles, of_an_empty_block_are_none) { EXPECT_TRUE(tiles_of({0, 0, 0, 5}).empty()); }

TEST(Tiles, have_no_slivers) {
  for (const PixelRect& tile : tiles_of({0, 0, 272, 256})) EXPECT_GE(tile.width, 128);
}

}  // namespace
}  // namespace cyclorama::balance
