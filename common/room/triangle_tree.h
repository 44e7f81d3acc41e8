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

/// Triangles in a tree of bounding boxes, split at the median, to find a ray's first hit. Computes in double. A value;
/// reentrant.
class TriangleTree {
 public:
  TriangleTree() = default;
  explicit TriangleTree(std::vector<TriangleCorners> triangles);

  struct Hit {
    std::size_t triangle = 0;
    double along = 0.0;  ///< Distance in units of the ray's direction.
  };
  /// Returns the first triangle that the ray hits from the side on which its corners run counter-clockwise. There are
  /// no gaps between neighbours.
  [[nodiscard]] std::optional<Hit> hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;
  [[nodiscard]] std::span<const TriangleCorners> triangles() const { return triangles_; }

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    /// Leaf: index of its first triangle in order_. Inner node (count 0): index of its second child; its first child is
    /// the next node.
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  void build(std::uint32_t first, std::uint32_t end);

  std::vector<TriangleCorners> triangles_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace cyclorama
