// SPDX-License-Identifier: Apache-2.0
/// Polygons around sets of ground cells.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace cyclorama::scene {

/// A set of cells of a grid seen from above, with one bit for each cell.
class CellSet {
 public:
  CellSet(int width, int depth)
      : width_(width), depth_(depth), bits_(static_cast<std::size_t>(width) * static_cast<std::size_t>(depth), false) {}
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int depth() const { return depth_; }
  /// Returns false outside the grid.
  [[nodiscard]] bool has(int x, int z) const {
    return x >= 0 && z >= 0 && x < width_ && z < depth_ && bits_[index_of(x, z)];
  }
  void add(int x, int z) { bits_[index_of(x, z)] = true; }
  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(std::count(bits_.begin(), bits_.end(), true));
  }

 private:
  [[nodiscard]] std::size_t index_of(int x, int z) const {
    return static_cast<std::size_t>(z) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  int width_;
  int depth_;
  std::vector<bool> bits_;
};

/// Returns the cells of `set` connected by their sides to the start cell; the result is empty if the start cell is not
/// in `set`.
[[nodiscard]] CellSet reached_from(const CellSet& set, int start_x, int start_z);

/// Returns the borders of `set` as cell corners (x, z), ordered by their first corner: lowest z, then lowest x. For a
/// connected set the outline comes first, then its holes. Cells that touch only at a corner are not joined.
[[nodiscard]] std::vector<std::vector<Eigen::Vector2i>> borders_of(const CellSet& set);

/// Simplifies a closed line by Douglas and Peucker's method: no removed corner is farther than `tolerance` from the
/// result.
[[nodiscard]] std::vector<Eigen::Vector2d> simplified(const std::vector<Eigen::Vector2d>& corners, double tolerance);

}  // namespace cyclorama::scene
