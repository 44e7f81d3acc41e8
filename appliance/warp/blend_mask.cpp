// SPDX-License-Identifier: Apache-2.0
#include "appliance/warp/blend_mask.h"

namespace cyclorama {
namespace {

/// 1 in the middle of the picture, 0 at its edges.
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
  constexpr int kAcross = 512;
  constexpr int kDown = 256;
  const std::vector<ProjectorMap> maps = projector_maps(installation);
  const CylinderWall& wall = installation.wall;
  int unlit = 0;
  for (int j = 0; j <= kDown; ++j) {
    const double height = wall.bottom_m + (wall.top_m - wall.bottom_m) * j / kDown;
    for (int i = 0; i <= kAcross; ++i) {
      const Point<frame::Room> point = wall.point_at(wall.arc_rad * (static_cast<double>(i) / kAcross - 0.5), height);
      bool lit = false;
      for (const ProjectorMap& map : maps) lit = lit || map.pixel_lighting(point).has_value();
      if (!lit) ++unlit;
    }
  }
  return static_cast<double>(unlit) / ((kAcross + 1) * (kDown + 1));
}

}  // namespace cyclorama
