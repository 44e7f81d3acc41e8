// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "drivers/simulated/museum/true_wall.h"

namespace cyclorama::simulated {

/// A wall divided into cells, in rows and columns per part, for slowly varying light. A value; reentrant.
class WallCells {
 public:
  struct Grid {
    std::size_t first = 0;  ///< Index of its first cell.
    int columns = 1;
    int rows = 1;
  };
  /// Four cells and their weights, which sum to 1: bilinear between the cells' centres.
  struct Share {
    std::array<std::size_t, 4> cells{};
    std::array<double, 4> weights{};
  };

  /// Divides the wall into nearly square cells; their number is close to `about`.
  WallCells(const TrueWall& wall, int about);

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] const std::vector<Grid>& grids() const { return grids_; }
  /// Corners of a cell: its lower and upper bounds.
  [[nodiscard]] WallPosition low(std::size_t cell) const { return corner(cell, 0); }
  [[nodiscard]] WallPosition high(std::size_t cell) const { return corner(cell, 1); }
  [[nodiscard]] Share share(const WallPosition& position) const;

 private:
  [[nodiscard]] WallPosition corner(std::size_t cell, int end) const;
  std::vector<Grid> grids_;
  std::size_t count_ = 0;
  bool goes_round_ = false;
};

}  // namespace cyclorama::simulated
