// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/lit_triangles.h"

#include <algorithm>
#include <span>

namespace cyclorama::display {
namespace {

struct Limits {
  float min = 1.0f;
  float max = 0.0f;
};

/// Returns the mask's limits, and the maximum of the black lift, in the box around three corners.
Limits mask_around(const warp::WarpMesh& mesh, const warp::MaskImage& mask, const warp::BlackLiftImage* black_lift,
                   std::span<const std::uint32_t> triangle) {
  float left = static_cast<float>(mask.width());
  float top = static_cast<float>(mask.height());
  float right = 0.0f;
  float bottom = 0.0f;
  for (const std::uint32_t corner : triangle) {
    const warp::WarpVertex& v = mesh.vertices[corner];
    left = std::min(left, v.x_px);
    right = std::max(right, v.x_px);
    top = std::min(top, v.y_px);
    bottom = std::max(bottom, v.y_px);
  }
  const int last_x = std::min(mask.width() - 1, static_cast<int>(right));
  const int last_y = std::min(mask.height() - 1, static_cast<int>(bottom));
  Limits limits;
  for (int y = static_cast<int>(top); y <= last_y; ++y) {
    for (int x = static_cast<int>(left); x <= last_x; ++x) {
      limits.min = std::min(limits.min, *mask.at(x, y));
      limits.max = std::max({limits.max, *mask.at(x, y), black_lift == nullptr ? 0.0f : *black_lift->at(x, y)});
    }
  }
  return limits;
}

}  // namespace

LitTriangles lit_triangles(const warp::WarpMesh& mesh, const warp::MaskImage& mask,
                           const warp::BlackLiftImage* black_lift) {
  const std::vector<std::uint32_t> all = mesh.triangles();
  LitTriangles lit;
  for (std::size_t i = 0; i + 2 < all.size(); i += 3) {
    const std::span<const std::uint32_t> triangle(all.data() + i, 3);
    const Limits limits = mask_around(mesh, mask, black_lift, triangle);
    if (!(limits.max > 0.0f)) continue;
    std::vector<std::uint32_t>& kind = limits.min >= 1.0f ? lit.whole : lit.masked;
    kind.insert(kind.end(), triangle.begin(), triangle.end());
  }
  return lit;
}

}  // namespace cyclorama::display
