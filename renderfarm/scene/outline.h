// SPDX-License-Identifier: Apache-2.0
/// From cells on the ground to the polygons around them.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

namespace cyclorama {

/// One bit for each cell of a grid seen from above.
class CellSet {
 public:
  CellSet(int width, int depth)
      : width_(width), depth_(depth), bits_(static_cast<std::size_t>(width) * static_cast<std::size_t>(depth), false) {}
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int depth() const { return depth_; }
  /// False outside.
  [[nodiscard]] bool has(int x, int z) const {
    return x >= 0 && z >= 0 && x < width_ && z < depth_ && bits_[index_of(x, z)];
  }
  void add(int x, int z) { bits_[index_of(x, z)] = true; }

 private:
  [[nodiscard]] std::size_t index_of(int x, int z) const {
    return static_cast<std::size_t>(z) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  int width_;
  int depth_;
  std::vector<bool> bits_;
};

/// The cells that can be reached from one of `set`, side by side; none when it is not in it.
[[nodiscard]] CellSet reached_from(const CellSet& set, int start_x, int start_z);

/// The borders of `set` as corners of cells (x, z), by where they begin: least z, then least x. So of a connected set
/// the outline comes first, and then its holes. Cells that touch at a corner only are not joined.
[[nodiscard]] std::vector<std::vector<Eigen::Vector2i>> borders_of(const CellSet& set);

/// Douglas and Peucker's simplification of a closed line: no corner that is left out lies farther than `tolerance`
/// away.
[[nodiscard]] std::vector<Eigen::Vector2d> simplified(const std::vector<Eigen::Vector2d>& corners, double tolerance);

}  // namespace cyclorama
