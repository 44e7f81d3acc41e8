// SPDX-License-Identifier: Apache-2.0
/// How triangles hang together by their edges.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace cyclorama::scene {

/// Triangles of any number of meshes. Corners at equal positions have the same number.
struct TriangleSoup {
  std::vector<Eigen::Vector3d> places;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// A part of a soup whose triangles share edges. An edge of more than two triangles joins none of them.
struct Sheet {
  std::size_t triangles = 0;
  std::size_t turned = 0;  ///< Triangles that face the other way than the others; fewer than half of its area.
  bool twisted = false;    ///< No choice of sides fits all of its triangles, as on a Möbius strip.
  bool closed = true;      ///< It has no edge of a single triangle.
  double area = 0.0;
  /// Volume inside, in the sense that the most triangles have; negative if they face inwards.
  double volume = 0.0;
};

/// A chain of edges that belong to one triangle each.
struct Rim {
  std::uint32_t sheet = 0;
  std::vector<std::uint32_t> corners;  ///< In the order of the triangles' corners. Ends where that is reversed.
};

inline constexpr std::uint32_t kNoSheet = ~std::uint32_t{0};

struct Topology {
  std::vector<std::uint32_t> sheet_of;  ///< One per triangle; kNoSheet for triangles with fewer than three corners.
  std::vector<bool> has_area;           ///< One per triangle. Those without join their neighbours all the same.
  std::vector<bool> is_turned;          ///< One per triangle.
  std::vector<Sheet> sheets;
  std::vector<Rim> rims;
};

/// Takes about a second for each million triangles, and some 150 bytes for each triangle. Precondition: indices are in range. Reentrant.
[[nodiscard]] Topology topology_of(const TriangleSoup& soup);

}  // namespace cyclorama::scene
