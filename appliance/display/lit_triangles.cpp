// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/lit_triangles.h"

#include <algorithm>
#include <span>

namespace cyclorama {
namespace {

struct Limits {
  float least = 1.0f;
  float most = 0.0f;
};

/// Of the mask, and the most of the lift, in the box around three corners.
Limits mask_around(const WarpMesh& mesh, const MaskImage& mask, const LiftImage* lift,
                   std::span<const std::uint32_t> triangle) {
  float left = static_cast<float>(mask.width());
  float top = static_cast<float>(mask.height());
  float right = 0.0f;
  float bottom = 0.0f;
  for (const std::uint32_t corner : triangle) {
    const WarpVertex& v = mesh.vertices[corner];
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
      limits.least = std::min(limits.least, *mask.at(x, y));
      limits.most = std::max({limits.most, *mask.at(x, y), lift == nullptr ? 0.0f : *lift->at(x, y)});
    }
  }
  return limits;
}

}  // namespace

LitTriangles lit_triangles(const WarpMesh& mesh, const MaskImage& mask, const LiftImage* lift) {
  const std::vector<std::uint32_t> all = mesh.triangles();
  LitTriangles lit;
  for (std::size_t i = 0; i + 2 < all.size(); i += 3) {
    const std::span<const std::uint32_t> triangle(all.data() + i, 3);
    const Limits limits = mask_around(mesh, mask, lift, triangle);
    if (!(limits.most > 0.0f)) continue;
    std::vector<std::uint32_t>& kind = limits.least >= 1.0f ? lit.whole : lit.masked;
    kind.insert(kind.end(), triangle.begin(), triangle.end());
  }
  return lit;
}

}  // namespace cyclorama
