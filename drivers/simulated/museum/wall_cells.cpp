// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/wall_cells.h"

#include <algorithm>
#include <cmath>

#include "common/base/check.h"

namespace cyclorama::simulated {

WallCells::WallCells(const TrueWall& wall, int about) : goes_round_(wall.goes_round()) {
  double area = 0.0;
  for (std::size_t part = 0; part < wall.part_count(); ++part) area += wall.size_m(part).prod();
  const double side = std::sqrt(area / std::max(about, 1));
  for (std::size_t part = 0; part < wall.part_count(); ++part) {
    const Eigen::Vector2d size = wall.size_m(part);
    const int columns = std::max(goes_round_ ? 8 : 2, static_cast<int>(std::lround(size.x() / side)));
    const int rows = std::max(2, static_cast<int>(std::lround(size.y() / side)));
    grids_.push_back({count_, columns, rows});
    count_ += static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  }
}

WallPosition WallCells::corner(std::size_t cell, int end) const {
  CHECK(cell < count_);
  std::size_t part = grids_.size() - 1;
  while (grids_[part].first > cell) --part;
  const Grid& grid = grids_[part];
  const int index = static_cast<int>(cell - grid.first);
  return {part, static_cast<double>(index % grid.columns + end) / grid.columns,
          static_cast<double>(index / grid.columns + end) / grid.rows};
}

WallCells::Share WallCells::share(const WallPosition& position) const {
  const Grid& grid = grids_[position.part];
  const double x = position.across * grid.columns - 0.5;
  const double y = std::clamp(position.along * grid.rows - 0.5, 0.0, grid.rows - 1.0);
  const double inside_x = goes_round_ ? x : std::clamp(x, 0.0, grid.columns - 1.0);
  const int x0 = static_cast<int>(std::floor(inside_x));
  const int y0 = std::min(static_cast<int>(y), grid.rows - 2);
  const auto column = [&](int i) {
    return goes_round_ ? ((i % grid.columns) + grid.columns) % grid.columns : std::clamp(i, 0, grid.columns - 1);
  };
  const auto cell = [&](int i, int j) {
    return grid.first + static_cast<std::size_t>(j) * static_cast<std::size_t>(grid.columns) +
           static_cast<std::size_t>(column(i));
  };
  const double fx = inside_x - x0;
  const double fy = y - y0;
  return {{cell(x0, y0), cell(x0 + 1, y0), cell(x0, y0 + 1), cell(x0 + 1, y0 + 1)},
          {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy}};
}

}  // namespace cyclorama::simulated
