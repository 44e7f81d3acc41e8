// SPDX-License-Identifier: Apache-2.0
#include "common/image/cells.h"

#include <gtest/gtest.h>

namespace cyclorama {
namespace {

TEST(Cells, are_those_that_a_rectangle_touches) {
  EXPECT_EQ(cells_touched({0, 0, 16, 16}), (PixelRect{0, 0, 1, 1}));
  EXPECT_EQ(cells_touched({16, 32, 17, 15}), (PixelRect{1, 2, 2, 1}));
  EXPECT_EQ(cells_touched({15, 31, 2, 2}), (PixelRect{0, 1, 2, 2}));
  EXPECT_EQ(cells_touched({61, 37, 1, 1}), (PixelRect{3, 2, 1, 1}));
  EXPECT_TRUE(cells_touched({16, 16, 0, 5}).empty());
}

TEST(Cells, are_stored_row_by_row) {
  const PixelRect cells{3, 5, 4, 2};
  std::size_t next = 0;
  for (int row = 5; row < 7; ++row) {
    for (int column = 3; column < 7; ++column) EXPECT_EQ(cell_index(cells, column, row), next++);
  }
}

}  // namespace
}  // namespace cyclorama
