// SPDX-License-Identifier: Apache-2.0
#include "appliance/warp/pixel_map.h"

#include <algorithm>

namespace cyclorama::warp {
namespace {
// Width of cells below which a pixel map is faster, measured by ./bench.sh display-trade on a software rasteriser.
constexpr int kMinCellPx = 12;
}  // namespace

PixelMap make_pixel_map(const ProjectorMap& map, const PictureShape& picture) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  PixelMap directions(map.lens().width_px, map.lens().height_px, kNone);
  for (int y = 0; y < directions.height(); ++y) {
    for (int x = 0; x < directions.width(); ++x) {
      const auto position = map.place_of({x + 0.5, y + 0.5}, picture);
      if (!position) continue;
      directions.at(x, y)[0] = static_cast<float>(position->across);
      directions.at(x, y)[1] = static_cast<float>(position->up);
    }
  }
  return directions;
}

bool is_quicker_than_a_map(const WarpMesh& mesh) {
  return mesh.cells_x * kMinCellPx <= mesh.width_px && mesh.cells_y * kMinCellPx <= mesh.height_px;
}

Result<Warp> make_warp(const ProjectorMap& map, const PictureShape& picture, double tolerance_px) {
  TRY(validate(picture));
  if (auto patches = make_warp_patches(map, picture, tolerance_px)) return Warp(*std::move(patches));
  const int max = std::max(1, map.lens().width_px * map.lens().height_px / (kMinCellPx * kMinCellPx));
  // N creases can cut the picture into about N^2 / 2 pieces. If that exceeds `max`, the cells between the creases would
  // be smaller than kMinCellPx, so no mesh is tried.
  const std::size_t creases = map.creases().size();
  if (creases * creases / 2 > static_cast<std::size_t>(max)) return Warp(make_pixel_map(map, picture));
  auto mesh = make_warp_mesh(map, picture, tolerance_px, max);
  if (mesh && is_quicker_than_a_map(*mesh)) return Warp(*std::move(mesh));
  return Warp(make_pixel_map(map, picture));
}

int width_px(const Warp& warp) {
  const auto* const map = std::get_if<PixelMap>(&warp);
  if (map != nullptr) return map->width();
  const auto* const mesh = std::get_if<WarpMesh>(&warp);
  return mesh != nullptr ? mesh->width_px : std::get<WarpPatches>(warp).width_px;
}

int height_px(const Warp& warp) {
  const auto* const map = std::get_if<PixelMap>(&warp);
  if (map != nullptr) return map->height();
  const auto* const mesh = std::get_if<WarpMesh>(&warp);
  return mesh != nullptr ? mesh->height_px : std::get<WarpPatches>(warp).height_px;
}

std::optional<PanoramaDirection> direction_at(const Warp& warp, int x, int y) {
  const Eigen::Vector2d centre(x + 0.5, y + 0.5);
  if (const auto* const mesh = std::get_if<WarpMesh>(&warp)) return mesh->interpolate(centre);
  if (const auto* const patches = std::get_if<WarpPatches>(&warp)) return patches->at(centre);
  const float* const direction = std::get<PixelMap>(warp).at(x, y);
  const auto azimuth = static_cast<double>(direction[0]);
  const auto tan_elevation = static_cast<double>(direction[1]);
  if (azimuth != azimuth || tan_elevation != tan_elevation) return std::nullopt;
  return PanoramaDirection{azimuth, tan_elevation};
}

}  // namespace cyclorama::warp
