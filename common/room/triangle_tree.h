// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace cyclorama {

using TriangleCorners = std::array<Eigen::Vector3d, 3>;

/// Triangles in a tree of boxes, halved at the median: which one does a ray meet first? In double. A value; reentrant.
class TriangleTree {
 public:
  TriangleTree() = default;
  explicit TriangleTree(std::vector<TriangleCorners> triangles);

  struct Hit {
    std::size_t triangle = 0;
    double along = 0.0;  ///< In lengths of the ray's direction.
  };
  /// Only from the side on which the corners run counter-clockwise. Neighbours leave no gap.
  [[nodiscard]] std::optional<Hit> hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;
  [[nodiscard]] std::span<const TriangleCorners> triangles() const { return triangles_; }

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    std::uint32_t first =
        0;  ///< Of its triangles in order_; with count 0: its second child; the first is the next node.
    std::uint32_t count = 0;
  };
  void build(std::uint32_t first, std::uint32_t end);

  std::vector<TriangleCorners> triangles_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace cyclorama
