// SPDX-License-Identifier: Apache-2.0
/// Coarse occupancy grid of a scene, which suffices to find a standing position and a viewing direction without a BVH.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Grid of cubic cells over the scene's bounds or a part of them, 96 along the longest side. Immutable once built;
/// reentrant.
class SpaceGrid {
 public:
  /// Precondition: `bounds` is not empty; what lies outside of it is left out. Takes some nanoseconds per triangle and
  /// at most a second or two, because very many triangles are sampled more sparsely.
  SpaceGrid(const Model& model, const Eigen::AlignedBox3d& bounds);

  [[nodiscard]] double cell_m() const { return cell_m_; }
  [[nodiscard]] const Eigen::Vector3i& cells() const { return cells_; }
  [[nodiscard]] Eigen::Vector3d centre_of(const Eigen::Vector3i& cell) const {
    return min_ + (cell.cast<double>().array() + 0.5).matrix() * cell_m_;
  }
  /// Returns the cell that contains `p`; it may be outside the grid.
  [[nodiscard]] Eigen::Vector3i cell_of(const Eigen::Vector3d& p) const {
    return ((p - min_) / cell_m_).array().floor().cast<int>();
  }
  [[nodiscard]] bool contains(const Eigen::Vector3i& cell) const {
    return (cell.array() >= 0).all() && (cell.array() < cells_.array()).all();
  }
  /// Returns false outside the grid.
  [[nodiscard]] bool is_solid(const Eigen::Vector3i& cell) const { return contains(cell) && at(cell).top > -kNowhere; }
  /// Returns the height of the highest surface in a solid cell.
  [[nodiscard]] double top_of(const Eigen::Vector3i& cell) const { return double{at(cell).top}; }

  struct Ray {
    double length_m = 0.0;  ///< Distance to the hit, or to the point where the ray leaves the grid.
    bool hits = false;
    bool from_behind = false;  ///< The ray hits a back face, so it starts inside a solid object.
  };
  /// Casts a ray from `from` along `direction` (unit length). Ignores the cell of `from`.
  [[nodiscard]] Ray cast(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) const;

 private:
  static constexpr float kNowhere = 1e30f;
  struct Cell {
    float top = -kNowhere;
    Eigen::Vector3f facing = Eigen::Vector3f::Zero();  ///< Sum of the unit normals of the surfaces in the cell.
  };
  [[nodiscard]] const Cell& at(const Eigen::Vector3i& cell) const { return data_[index_of(cell)]; }
  [[nodiscard]] std::size_t index_of(const Eigen::Vector3i& cell) const;
  [[nodiscard]] bool is_outside(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) const;
  void mark(const Eigen::Vector3d& p, const Eigen::Vector3f& normal);
  void mark_triangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);
  void mark_instance(const Mesh& mesh, const Instance& instance);

  Eigen::Vector3d min_;
  double cell_m_ = 1.0;
  Eigen::Vector3i cells_;
  std::vector<Cell> data_;
  std::size_t marks_left_;
};

}  // namespace cyclorama::scene
