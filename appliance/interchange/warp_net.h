// SPDX-License-Identifier: Apache-2.0
/// A warp as a net of nodes, each of which says which place of the source picture appears where in the projector's:
/// what mesh formats (Bourke, OBJ, domeprojection, SimCAD) hold, and how they become maps per pixel and back.
///
/// Both pictures have x or u to the right and y or v UP from the lower left corner, 0 to 1. All values; reentrant.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "appliance/interchange/warp_set.h"

namespace cyclorama::interchange {

struct WarpNode {
  double x = 0.0;  ///< In the projector's picture; may lie outside of it.
  double y = 0.0;
  double u = 0.0;  ///< In the source picture.
  double v = 0.0;
  double light = 1.0;  ///< A factor on linear light, 0 to 1. Negative: nothing is drawn around this node.
  friend bool operator==(const WarpNode&, const WarpNode&) = default;
};

using WarpTriangle = std::array<std::uint32_t, 3>;  ///< Counts nodes.

/// Either a grid (columns and rows, triangles empty) or nodes with triangles (columns and rows 0).
struct WarpNet {
  int columns = 0;
  int rows = 0;
  bool closed = false;          ///< The last column is joined to the first (a polar grid).
  std::vector<WarpNode> nodes;  ///< A grid's row by row.
  std::vector<WarpTriangle> triangles;

  /// What is drawn: the triangles, or two per cell of the grid; without those that have a node of negative light.
  [[nodiscard]] std::vector<WarpTriangle> drawn() const;
  friend bool operator==(const WarpNet&, const WarpNet&) = default;
};

inline constexpr std::size_t kMaxWarpNodes = std::size_t{1} << 22;
inline constexpr std::size_t kMaxWarpTriangles = std::size_t{1} << 23;
inline constexpr std::size_t kWarpTextLimitBytes = std::size_t{512} << 20;

/// kBadData  counts that do not fit, numbers that are not finite or absurdly far out, triangles of absent nodes.
[[nodiscard]] Status check(const WarpNet& net);

/// A region of the 2d profile: each pixel's centre looked up in the triangle that covers it (the last one, where they
/// overlap), NaN where none does. Light becomes its alpha in 16 bits, unless it is 1 everywhere.
/// kBadData  as check(), or no pixel is covered.
Result<WarpRegion> region_from(const WarpNet& net, const std::string& id, int width_px, int height_px);

/// An even grid over a flat map, at least 2 by 2: light from its alpha, -1 where nothing is mapped.
/// kInvalidArgument  the region has no map, or the grid is out of range.
Result<WarpNet> net_from(const WarpRegion& region, int columns, int rows);

}  // namespace cyclorama::interchange
