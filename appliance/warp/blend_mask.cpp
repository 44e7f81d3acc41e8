// SPDX-License-Identifier: Apache-2.0
#include "appliance/warp/blend_mask.h"

#include <algorithm>

namespace cyclorama::warp {
namespace {

/// Returns 1 in the middle of the picture, falling to 0 at its edges: r of blend_weights().
double inwardness(const Pinhole& lens, const Eigen::Vector2d& pixel) {
  const double w = lens.width_px;
  const double h = lens.height_px;
  const double inward = 16.0 * pixel.x() * (w - pixel.x()) * pixel.y() * (h - pixel.y()) / (w * w * h * h);
  return inward * inward;
}

double inwardness(const ProjectorMap& map, const Point<frame::Room>& point) {
  const auto pixel = map.pixel_lighting(point);
  return pixel ? inwardness(map.lens(), *pixel) : 0.0;
}

MaskImage make_mask(const std::vector<ProjectorMap>& maps, std::size_t projector) {
  const Pinhole& lens = maps[projector].lens();
  MaskImage mask(lens.width_px, lens.height_px);
  for (int y = 0; y < lens.height_px; ++y) {
    for (int x = 0; x < lens.width_px; ++x) {
      const Eigen::Vector2d pixel(x + 0.5, y + 0.5);
      const auto point = maps[projector].wall_point_of(pixel);
      if (!point) continue;
      const double own = inwardness(lens, pixel);
      double sum = own;
      for (std::size_t other = 0; other < maps.size(); ++other) {
        if (other != projector) sum += inwardness(maps[other], *point);
      }
      *mask.at(x, y) = static_cast<float>(own / sum);
    }
  }
  return mask;
}

}  // namespace

std::vector<ProjectorMap> projector_maps(const Installation& installation) {
  std::vector<ProjectorMap> maps;
  for (std::size_t i = 0; i < installation.projectors.size(); ++i) maps.emplace_back(installation, i);
  return maps;
}

std::vector<double> blend_weights(const std::vector<ProjectorMap>& maps, const Point<frame::Room>& point) {
  std::vector<double> weights;
  double sum = 0.0;
  for (const ProjectorMap& map : maps) {
    weights.push_back(inwardness(map, point));
    sum += weights.back();
  }
  if (!(sum > 0.0)) return std::vector<double>(maps.size(), 0.0);
  for (double& weight : weights) weight /= sum;
  return weights;
}

std::vector<MaskImage> make_blend_masks(const std::vector<ProjectorMap>& maps) {
  std::vector<MaskImage> masks;
  for (std::size_t i = 0; i < maps.size(); ++i) masks.push_back(make_mask(maps, i));
  return masks;
}

double unlit_fraction(const Installation& installation) {
  constexpr std::size_t kPatches = 1 << 17;
  const std::vector<ProjectorMap> maps = projector_maps(installation);
  double unlit_m2 = 0.0;
  double all_m2 = 0.0;
  for (const WallPatch& patch : patches(installation.wall, kPatches)) {
    const bool lit = std::ranges::any_of(maps, [&](const ProjectorMap& m) { return !!m.pixel_lighting(patch.middle); });
    all_m2 += patch.area_m2;
    if (!lit) unlit_m2 += patch.area_m2;
  }
  return unlit_m2 / all_m2;
}

}  // namespace cyclorama::warp
