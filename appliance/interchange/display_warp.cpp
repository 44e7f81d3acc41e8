// SPDX-License-Identifier: Apache-2.0
#include "appliance/interchange/display_warp.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "appliance/interchange/fault.h"
#include "appliance/interchange/map_sampling.h"
#include "common/geometry/picture_place.h"

namespace cyclorama::interchange {
namespace {

constexpr int kMinCells = 8;
constexpr int kMinCellPx = 4;
// Excludes the upward direction, whose position in a panorama is infinite except for rounding.
constexpr double kMaxCoordinate = 1e9;
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// Positions of directions in a picture. Azimuths count from the middle of the mapped area, so that they do not jump
/// within one projector's picture.
class PicturePositions {
 public:
  PicturePositions(const DirectionMap& directions, const PictureShape& picture) : picture_(picture) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int y = 0; y < directions.height(); ++y) {
      for (int x = 0; x < directions.width(); ++x) {
        const float* const d = directions.at(x, y);
        if (!std::isnan(d[0])) sum += Eigen::Vector3f(d[0], d[1], d[2]).cast<double>();
      }
    }
    middle_rad_ = std::atan2(sum.x(), -sum.z());
  }
  [[nodiscard]] std::optional<PicturePlace> of(const Eigen::Vector3d& direction) const {
    const auto location = place_of(picture_, direction);
    if (!location || !(std::abs(location->across) < kMaxCoordinate) || !(std::abs(location->up) < kMaxCoordinate))
      return std::nullopt;
    return warp::counted_near(*location, picture_, middle_rad_);
  }
  /// Returns the position for a point of the projector's picture; `x` and `y` are 0 to 1 from its upper left corner.
  [[nodiscard]] std::optional<PicturePlace> at(const DirectionMap& directions, double x, double y) const {
    const auto direction = sample_map(directions, x, y);
    if (!direction) return std::nullopt;
    return of(*direction);
  }

 private:
  PictureShape picture_;
  double middle_rad_ = 0.0;
};

warp::WarpMesh sampled(const DirectionMap& directions, const PicturePositions& positions, int width_px, int height_px,
                       int cells_x, int cells_y) {
  warp::WarpMesh mesh{width_px, height_px, cells_x, cells_y, {}, 0.0};
  for (int j = 0; j <= cells_y; ++j) {
    for (int i = 0; i <= cells_x; ++i) {
      const double x = static_cast<double>(i) / cells_x;
      const double y = static_cast<double>(j) / cells_y;
      warp::WarpVertex vertex{static_cast<float>(width_px * x), static_cast<float>(height_px * y), kNone, kNone};
      if (const auto location = positions.at(directions, x, y)) {
        vertex.azimuth_rad = static_cast<float>(location->across);
        vertex.tan_elevation = static_cast<float>(location->up);
      }
      mesh.vertices.push_back(vertex);
    }
  }
  return mesh;
}

/// Extrapolates the mesh linearly by one vertex beyond the mapped area, from the two nearest vertices in each
/// direction.
void grow_rim(warp::WarpMesh* mesh) {
  const std::vector<warp::WarpVertex> old = mesh->vertices;
  const int across = mesh->cells_x + 1;
  const int down = mesh->cells_y + 1;
  const auto at = [&](int i, int j) -> const warp::WarpVertex* {
    if (i < 0 || j < 0 || i >= across || j >= down) return nullptr;
    const warp::WarpVertex& v =
        old[static_cast<std::size_t>(j) * static_cast<std::size_t>(across) + static_cast<std::size_t>(i)];
    return v.is_valid() ? &v : nullptr;
  };
  constexpr int kSteps[8][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}};
  for (int j = 0; j < down; ++j) {
    for (int i = 0; i < across; ++i) {
      warp::WarpVertex& vertex =
          mesh->vertices[static_cast<std::size_t>(j) * static_cast<std::size_t>(across) + static_cast<std::size_t>(i)];
      if (vertex.is_valid()) continue;
      float azimuth = 0.0f;
      float tangent = 0.0f;
      float count = 0.0f;
      for (const auto& step : kSteps) {
        const warp::WarpVertex* const near = at(i + step[0], j + step[1]);
        const warp::WarpVertex* const far = at(i + 2 * step[0], j + 2 * step[1]);
        if (near == nullptr || far == nullptr) continue;
        azimuth += 2.0f * near->azimuth_rad - far->azimuth_rad;
        tangent += 2.0f * near->tan_elevation - far->tan_elevation;
        count += 1.0f;
      }
      if (count == 0.0f) continue;
      vertex.azimuth_rad = azimuth / count;
      vertex.tan_elevation = tangent / count;
    }
  }
}

/// Returns the maximum distance between the mesh and a mapped sample; infinite if the mesh does not cover a mapped
/// sample.
double worst_error(const DirectionMap& directions, const PicturePositions& positions, const warp::WarpMesh& mesh,
                   const PixelScale& scale) {
  double worst = 0.0;
  for (int y = 0; y < directions.height(); ++y) {
    for (int x = 0; x < directions.width(); ++x) {
      const float* const d = directions.at(x, y);
      const auto truth =
          std::isnan(d[0]) ? std::nullopt : positions.of(Eigen::Vector3f(d[0], d[1], d[2]).cast<double>());
      if (!truth) continue;
      const auto meshed = mesh.interpolate(
          {mesh.width_px * (x + 0.5) / directions.width(), mesh.height_px * (y + 0.5) / directions.height()});
      if (!meshed) return std::numeric_limits<double>::infinity();
      worst = std::max(worst, scale.distance_px(*truth, {meshed->azimuth_rad, meshed->tan_elevation}));
    }
  }
  return worst;
}

MaskMap mask_map(const warp::MaskImage& mask) {
  MaskMap map(mask.width(), mask.height(), 1, 16);
  for (std::size_t i = 0; i < map.samples.size(); ++i) {
    const double light = std::clamp(static_cast<double>(mask.data()[i]), 0.0, 1.0);
    map.samples[i] = static_cast<std::uint16_t>(std::lround(65535.0 * light));
  }
  return map;
}

warp::MaskImage light_of(const MaskMap& mask, int width_px, int height_px) {
  warp::MaskImage light(width_px, height_px);
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      *light.at(x, y) = static_cast<float>(sample_light(mask, (x + 0.5) / width_px, (y + 0.5) / height_px));
    }
  }
  return light;
}

}  // namespace

Result<warp::WarpMesh> mesh_from(const DirectionMap& directions, int width_px, int height_px,
                                 const PictureShape& picture, double tolerance_px) {
  CHECK(!directions.empty() && width_px > 0 && height_px > 0 && tolerance_px > 0.0);
  const PicturePositions positions(directions, picture);
  const PixelScale scale = pixel_scale(picture);
  const auto max = [](int px) { return std::max(1, px / kMinCellPx); };
  for (int cells = kMinCells;; cells *= 2) {
    const int cells_x = std::min(cells, max(width_px));
    const int cells_y = std::min(cells, max(height_px));
    warp::WarpMesh mesh = sampled(directions, positions, width_px, height_px, cells_x, cells_y);
    grow_rim(&mesh);
    mesh.worst_error_px = worst_error(directions, positions, mesh, scale);
    const bool is_finest = cells_x == max(width_px) && cells_y == max(height_px);
    if (mesh.triangles().empty()) {
      if (is_finest) return fault("map", "too little of it is mapped to draw", "measure or export the region again");
    } else if (mesh.worst_error_px <= tolerance_px || is_finest) {
      return mesh;
    }
  }
}

Result<warp::Warp> warp_from(const DirectionMap& directions, int width_px, int height_px, const PictureShape& picture,
                             double tolerance_px) {
  TRY_ASSIGN(warp::WarpMesh mesh, mesh_from(directions, width_px, height_px, picture, tolerance_px));
  if (mesh.worst_error_px <= tolerance_px && warp::is_quicker_than_a_map(mesh)) return warp::Warp(std::move(mesh));
  const PicturePositions positions(directions, picture);
  warp::PixelMap map(width_px, height_px, kNone);
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      const auto location = positions.at(directions, (x + 0.5) / width_px, (y + 0.5) / height_px);
      if (!location) continue;
      map.at(x, y)[0] = static_cast<float>(location->across);
      map.at(x, y)[1] = static_cast<float>(location->up);
    }
  }
  return warp::Warp(std::move(map));
}

warp::MaskImage mask_of(const WarpRegion& region) {
  warp::MaskImage mask = region.alpha ? light_of(*region.alpha, region.width_px, region.height_px)
                                      : warp::MaskImage(region.width_px, region.height_px, 1.0f);
  if (!region.map) return mask;
  const WarpMap& map = *region.map;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      const int i = static_cast<int>((x + 0.5) * map.width() / mask.width());
      const int j = static_cast<int>((y + 0.5) * map.height() / mask.height());
      if (!is_mapped(map.at(i, j))) *mask.at(x, y) = 0.0f;
    }
  }
  return mask;
}

std::optional<warp::MaskImage> black_level_of(const WarpRegion& region) {
  if (!region.beta) return std::nullopt;
  return light_of(*region.beta, region.width_px, region.height_px);
}

WarpRegion region_of(const warp::WarpMesh& mesh, const warp::MaskImage& mask, const PictureShape& picture,
                     const std::string& id) {
  CHECK(mask.width() == mesh.width_px && mask.height() == mesh.height_px);
  WarpRegion region;
  region.id = id;
  region.width_px = mesh.width_px;
  region.height_px = mesh.height_px;
  region.alpha = mask_map(mask);
  region.map = WarpMap(mesh.width_px, mesh.height_px, kNone);
  for (int y = 0; y < mesh.height_px; ++y) {
    for (int x = 0; x < mesh.width_px; ++x) {
      const auto location = mesh.interpolate({x + 0.5, y + 0.5});
      const auto pixel =
          location ? pixel_of(picture, direction_of(picture, {location->azimuth_rad, location->tan_elevation}))
                   : std::nullopt;
      if (!pixel) continue;
      const double u = pixel->u / width_px(picture);
      const double v = 1.0 - pixel->v / height_px(picture);
      if (!(u >= 0.0 && u <= 1.0 && v >= 0.0 && v <= 1.0)) continue;
      float* const out = region.map->at(x, y);
      out[0] = static_cast<float>(u);
      out[1] = static_cast<float>(v);
      out[2] = 0.0f;
    }
  }
  return region;
}

WarpRegion region_in_space(const warp::ProjectorMap& map, const Point<frame::Room>& eye, const warp::MaskImage& mask,
                           const std::string& id) {
  WarpRegion region;
  region.id = id;
  region.width_px = map.lens().width_px;
  region.height_px = map.lens().height_px;
  region.alpha = mask_map(mask);
  region.unit = LengthUnit::kMetre;
  region.origin = DataOrigin::kIdealEyePoint;
  region.map = WarpMap(region.width_px, region.height_px, kNone);
  for (int y = 0; y < region.height_px; ++y) {
    for (int x = 0; x < region.width_px; ++x) {
      const auto point = map.wall_point_of({x + 0.5, y + 0.5});
      if (!point) continue;
      const Eigen::Vector3f seen = (point->xyz - eye.xyz).cast<float>();
      std::copy(seen.data(), seen.data() + 3, region.map->at(x, y));
    }
  }
  return region;
}

WarpSet set_of(const Installation& installation) {
  WarpSet set;
  set.profile = WarpProfile::kAdvanced3d;
  set.buffers.push_back({installation.name, 0, 0, {}});
  const std::vector<warp::ProjectorMap> maps = warp::projector_maps(installation);
  const std::vector<warp::MaskImage> masks = warp::make_blend_masks(maps);
  for (std::size_t i = 0; i < maps.size(); ++i) {
    set.buffers.back().regions.push_back(
        region_in_space(maps[i], installation.sweet_spot, masks[i], installation.projectors[i].name));
  }
  return set;
}

}  // namespace cyclorama::interchange
