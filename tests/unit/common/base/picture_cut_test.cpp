// SPDX-License-Identifier: Apache-2.0
#include "common/base/picture_cut.h"

#include <gtest/gtest.h>

namespace cyclorama {
namespace {

TEST(CoveredCells, covers_a_picture_that_ends_within_a_cell_once) {
  CoveredCells cells(40, 17);
  EXPECT_EQ(cells.count(), 6u);
  EXPECT_TRUE(cells.cover(0, 0, 32, 16));
  EXPECT_TRUE(cells.cover(32, 0, 8, 17));
  EXPECT_EQ(cells.covered(), 4u);
  EXPECT_TRUE(cells.cover(0, 16, 32, 1));
  EXPECT_EQ(cells.covered(), cells.count());
}

TEST(CoveredCells, counts_overlapping_tiles_once) {
  CoveredCells cells(64, 64);
  EXPECT_TRUE(cells.cover(48, 48, 16, 16));
  EXPECT_FALSE(cells.cover(0, 0, 64, 64));
  EXPECT_FALSE(cells.cover(32, 32, 17, 17)) << "it reaches into the cell by a pixel";
  EXPECT_EQ(cells.covered(), 1u);
}

}  // namespace
}  // namespace cyclorama
