// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light/light_store.h"

namespace cyclorama::light {

std::optional<Eigen::Vector3f> LightStore::in_grid(const SideLight& light, std::uint32_t grid,
                                                   const Eigen::Vector3f& weights) const {
  if (grid == TriangleGrid::kTraced) return std::nullopt;
  const int parts = TriangleGrid::parts(grid);
  const auto scale = static_cast<float>(parts);
  const float u = std::clamp(weights[1], 0.0f, 1.0f) * scale;
  const float v = std::clamp(weights[2], 0.0f, 1.0f) * scale;
  const int j = std::min(static_cast<int>(v), parts - 1);
  const int i = std::min(static_cast<int>(u), parts - 1 - j);
  const float part_u = std::min(u - static_cast<float>(i), 1.0f);
  const float part_v = std::min(v - static_cast<float>(j), 1.0f);
  const auto sample = [&](int column, int row) {
    return light
        .samples[TriangleGrid::offset(grid) + static_cast<std::uint32_t>(TriangleGrid::index(parts, column, row))];
  };
  // Each part is two triangles, but for the last one of a row.
  if (part_u + part_v <= 1.0f || i + j == parts - 1) {
    const float rest = std::max(0.0f, 1.0f - part_u - part_v);
    return mixed<3>({sample(i, j), sample(i + 1, j), sample(i, j + 1)}, {rest, part_u, part_v});
  }
  return mixed<3>({sample(i + 1, j + 1), sample(i, j + 1), sample(i + 1, j)},
                  {part_u + part_v - 1.0f, 1.0f - part_u, 1.0f - part_v});
}

std::size_t LightStore::sample_count() const {
  std::size_t count = 0;
  for (const SurfaceLight& surface : surfaces) {
    for (const SideLight& side : surface.sides) count += side.base.size() + side.samples.size();
  }
  return count;
}

std::size_t LightStore::bytes() const {
  std::size_t count = sample_count();
  for (const SurfaceLight& surface : surfaces) {
    for (const SideLight& side : surface.sides) count += side.grids.size();
  }
  return count * sizeof(std::uint32_t) + surfaces.size() * sizeof(SurfaceLight);
}

}  // namespace cyclorama::light
