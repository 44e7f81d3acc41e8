// SPDX-License-Identifier: Apache-2.0
#include "appliance/interchange/display_warp.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "appliance/interchange/fault.h"
#include "appliance/interchange/map_sampling.h"
#include "common/geometry/panorama.h"

namespace cyclorama {
namespace {

constexpr int kFewestCells = 8;
constexpr int kFinestCellPx = 4;
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// Azimuths count from the middle of what is mapped, so that none jumps inside of one projector's picture.
double middle_azimuth(const DirectionMap& directions) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int y = 0; y < directions.height(); ++y) {
    for (int x = 0; x < directions.width(); ++x) {
      const float* const d = directions.at(x, y);
      if (!std::isnan(d[0])) sum += Eigen::Vector3f(d[0], d[1], d[2]).cast<double>();
    }
  }
  return std::atan2(sum.x(), -sum.z());
}

std::optional<PanoramaDirection> counted(const Eigen::Vector3d& direction, double middle_rad) {
  const double level = std::hypot(direction.x(), direction.z());
  if (!(level > 1e-9)) return std::nullopt;  // Straight up or down has no azimuth.
  const double azimuth = std::atan2(direction.x(), -direction.z());
  return PanoramaDirection{middle_rad + wrapped_angle(azimuth - middle_rad), direction.y() / level};
}

WarpMesh sampled(const DirectionMap& directions, double middle_rad, int width_px, int height_px, int cells_x,
                 int cells_y) {
  WarpMesh mesh;
  mesh.width_px = width_px;
  mesh.height_px = height_px;
  mesh.cells_x = cells_x;
  mesh.cells_y = cells_y;
  for (int j = 0; j <= cells_y; ++j) {
    for (int i = 0; i <= cells_x; ++i) {
      const double x = static_cast<double>(i) / cells_x;
      const double y = static_cast<double>(j) / cells_y;
      WarpVertex vertex{static_cast<float>(width_px * x), static_cast<float>(height_px * y), kNone, kNone};
      if (const auto sample = sample_map(directions, x, y)) {
        if (const auto direction = counted(*sample, middle_rad)) {
          vertex.azimuth_rad = static_cast<float>(direction->azimuth_rad);
          vertex.tan_elevation = static_cast<float>(direction->tan_elevation);
        }
      }
      mesh.vertices.push_back(vertex);
    }
  }
  return mesh;
}

/// Continues rows and columns by one vertex beyond what is mapped: straight on from the two nearest.
void grow_rim(WarpMesh* mesh) {
  const std::vector<WarpVertex> old = mesh->vertices;
  const int across = mesh->cells_x + 1;
  const int down = mesh->cells_y + 1;
  const auto at = [&](int i, int j) -> const WarpVertex* {
    if (i < 0 || j < 0 || i >= across || j >= down) return nullptr;
    const WarpVertex& v =
        old[static_cast<std::size_t>(j) * static_cast<std::size_t>(across) + static_cast<std::size_t>(i)];
    return v.is_valid() ? &v : nullptr;
  };
  constexpr int kSteps[8][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}};
  for (int j = 0; j < down; ++j) {
    for (int i = 0; i < across; ++i) {
      WarpVertex& vertex =
          mesh->vertices[static_cast<std::size_t>(j) * static_cast<std::size_t>(across) + static_cast<std::size_t>(i)];
      if (vertex.is_valid()) continue;
      float azimuth = 0.0f;
      float tangent = 0.0f;
      float count = 0.0f;
      for (const auto& step : kSteps) {
        const WarpVertex* const near = at(i + step[0], j + step[1]);
        const WarpVertex* const far = at(i + 2 * step[0], j + 2 * step[1]);
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

Eigen::Vector3d vector_of(const PanoramaDirection& d) {
  return Eigen::Vector3d(std::sin(d.azimuth_rad), d.tan_elevation, -std::cos(d.azimuth_rad)).normalized();
}

/// The largest angle between the mesh and a mapped sample that it draws.
double worst_angle(const DirectionMap& directions, const WarpMesh& mesh) {
  double worst = 0.0;
  for (int y = 0; y < directions.height(); ++y) {
    for (int x = 0; x < directions.width(); ++x) {
      const float* const d = directions.at(x, y);
      if (std::isnan(d[0])) continue;
      const auto meshed = mesh.interpolate(
          {mesh.width_px * (x + 0.5) / directions.width(), mesh.height_px * (y + 0.5) / directions.height()});
      if (!meshed) continue;
      const Eigen::Vector3d truth = Eigen::Vector3f(d[0], d[1], d[2]).cast<double>();
      worst = std::max(worst, (vector_of(*meshed) - truth).norm());
    }
  }
  return worst;
}

/// The mean angle from one projector pixel to the next, across.
double radians_per_px(const DirectionMap& directions, int width_px) {
  double sum = 0.0;
  double count = 0.0;
  for (int y = 0; y < directions.height(); ++y) {
    for (int x = 0; x + 1 < directions.width(); ++x) {
      const float* const a = directions.at(x, y);
      const float* const b = directions.at(x + 1, y);
      if (std::isnan(a[0]) || std::isnan(b[0])) continue;
      sum += (Eigen::Vector3f(a[0], a[1], a[2]) - Eigen::Vector3f(b[0], b[1], b[2])).cast<double>().norm();
      count += 1.0;
    }
  }
  if (!(sum > 0.0)) return 1.0;
  return sum / count * directions.width() / width_px;
}

MaskMap mask_map(const MaskImage& mask) {
  MaskMap map(mask.width(), mask.height(), 1, 16);
  for (std::size_t i = 0; i < map.samples.size(); ++i) {
    const double light = std::clamp(static_cast<double>(mask.data()[i]), 0.0, 1.0);
    map.samples[i] = static_cast<std::uint16_t>(std::lround(65535.0 * light));
  }
  return map;
}

MaskImage light_of(const MaskMap& mask, int width_px, int height_px) {
  MaskImage light(width_px, height_px);
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      *light.at(x, y) = static_cast<float>(sample_light(mask, (x + 0.5) / width_px, (y + 0.5) / height_px));
    }
  }
  return light;
}

}  // namespace

Result<WarpMesh> mesh_from(const DirectionMap& directions, int width_px, int height_px, double tolerance_rad) {
  CHECK(!directions.empty() && width_px > 0 && height_px > 0 && tolerance_rad > 0.0);
  const double middle_rad = middle_azimuth(directions);
  const double pixel_rad = radians_per_px(directions, width_px);
  const auto most = [](int px) { return std::max(1, px / kFinestCellPx); };
  for (int cells = kFewestCells;; cells *= 2) {
    const int cells_x = std::min(cells, most(width_px));
    const int cells_y = std::min(cells, most(height_px));
    WarpMesh mesh = sampled(directions, middle_rad, width_px, height_px, cells_x, cells_y);
    grow_rim(&mesh);
    const double worst_rad = worst_angle(directions, mesh);
    mesh.worst_error_px = worst_rad / pixel_rad;
    const bool is_finest = cells_x == most(width_px) && cells_y == most(height_px);
    if (mesh.triangles().empty()) {
      if (is_finest) return fault("map", "too little of it is mapped to draw", "measure or export the region again");
    } else if (worst_rad <= tolerance_rad || is_finest) {
      return mesh;
    }
  }
}

MaskImage mask_of(const WarpRegion& region) {
  MaskImage mask = region.alpha ? light_of(*region.alpha, region.width_px, region.height_px)
                                : MaskImage(region.width_px, region.height_px, 1.0f);
  if (!region.map) return mask;
  const WarpMap& map = *region.map;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      const int i = static_cast<int>((x + 0.5) * map.width() / mask.width());
      const int j = static_cast<int>((y + 0.5) * map.height() / mask.height());
      const float* const sample = map.at(i, j);
      if (std::isnan(sample[0]) || std::isnan(sample[1])) *mask.at(x, y) = 0.0f;
    }
  }
  return mask;
}

std::optional<MaskImage> black_level_of(const WarpRegion& region) {
  if (!region.beta) return std::nullopt;
  return light_of(*region.beta, region.width_px, region.height_px);
}

WarpRegion region_of(const WarpMesh& mesh, const MaskImage& mask, const PictureShape& picture, const std::string& id) {
  CHECK(mask.width() == mesh.width_px && mask.height() == mesh.height_px);
  WarpRegion region;
  region.id = id;
  region.width_px = mesh.width_px;
  region.height_px = mesh.height_px;
  region.alpha = mask_map(mask);
  region.map = WarpMap(mesh.width_px, mesh.height_px, kNone);
  for (int y = 0; y < mesh.height_px; ++y) {
    for (int x = 0; x < mesh.width_px; ++x) {
      const auto direction = mesh.interpolate({x + 0.5, y + 0.5});
      const auto pixel = direction ? pixel_of(picture, vector_of(*direction)) : std::nullopt;
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

WarpRegion region_in_space(const ProjectorMap& map, const Point<frame::Room>& eye, const MaskImage& mask,
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
  const std::vector<ProjectorMap> maps = projector_maps(installation);
  const std::vector<MaskImage> masks = make_blend_masks(maps);
  for (std::size_t i = 0; i < maps.size(); ++i) {
    set.buffers.back().regions.push_back(
        region_in_space(maps[i], installation.sweet_spot, masks[i], installation.projectors[i].name));
  }
  return set;
}

}  // namespace cyclorama
