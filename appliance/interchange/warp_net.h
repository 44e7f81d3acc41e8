// SPDX-License-Identifier: Apache-2.0
/// A warp as a net of nodes, each of which maps a position in the source picture to a position in the projector's
/// picture. It is the common model of mesh formats (Bourke, OBJ, domeprojection, SimCAD), with conversions from and to
/// maps per pixel.
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
  double x = 0.0;  ///< In the projector's picture; may be outside of it.
  double y = 0.0;
  double u = 0.0;  ///< In the source picture.
  double v = 0.0;
  double light = 1.0;  ///< Factor on linear light, 0 to 1. If negative, nothing is drawn around this node.
  friend bool operator==(const WarpNode&, const WarpNode&) = default;
};

using WarpTriangle = std::array<std::uint32_t, 3>;  ///< Indices of nodes.

/// Either a grid (columns and rows, triangles empty) or nodes with triangles (columns and rows 0).
struct WarpNet {
  int columns = 0;
  int rows = 0;
  bool closed = false;          ///< True if the last column is connected to the first (a polar grid).
  std::vector<WarpNode> nodes;  ///< Row by row in a grid.
  std::vector<WarpTriangle> triangles;

  /// Returns the triangles to draw: those of the net, or two per cell of the grid. Triangles with a node of negative
  /// light are omitted.
  [[nodiscard]] std::vector<WarpTriangle> drawn() const;
  friend bool operator==(const WarpNet&, const WarpNet&) = default;
};

inline constexpr std::size_t kMaxWarpNodes = std::size_t{1} << 22;
inline constexpr std::size_t kMaxWarpTriangles = std::size_t{1} << 23;
inline constexpr std::size_t kWarpTextLimitBytes = std::size_t{512} << 20;

/// Checks a net. Errors: kBadData if counts do not match, numbers are not finite or far out of range, or a triangle's
/// node does not exist.
[[nodiscard]] Status check(const WarpNet& net);

/// Returns a region of the 2d profile. Each pixel's centre is interpolated in the triangle that covers it (the last of
/// several); it is NaN if there is none. Light becomes the alpha in 16 bits, unless it is 1 everywhere. Errors: those
/// of check(); kBadData if no pixel is covered.
Result<WarpRegion> region_from(const WarpNet& net, const std::string& id, int width_px, int height_px);

/// Returns a regular grid of at least 2 by 2 nodes over a flat map. Light is that of the alpha, and -1 where nothing is
/// mapped. Errors: kInvalidArgument if the region has no map, or the grid is out of range.
Result<WarpNet> net_from(const WarpRegion& region, int columns, int rows);

}  // namespace cyclorama::interchange
