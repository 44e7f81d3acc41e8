// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/camera_table.h"

#include <cmath>
#include <limits>

#include "drivers/simulated/museum/parallel_rows.h"

namespace cyclorama::simulated {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// Light of one projector at a camera pixel; u is kNone if no light of the projector arrives there.
struct Light {
  float u = kNone;
  float v = kNone;
  float gain_lux = 0.0f;
  float defocus_px = 0.0f;
};

struct Grid {
  int width = 0;
  int height = 0;
  [[nodiscard]] std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

/// Change of (u, v) from one camera pixel to the next in a direction: a central difference if both neighbours see the
/// same part of the wall, otherwise a one-sided difference.
Eigen::Vector2d slope(const std::vector<Light>& lights, const std::vector<CameraTable::Place>& positions,
                      std::size_t here, std::size_t before, std::size_t after) {
  const auto is_like = [&](std::size_t other) {
    return positions[other].part == positions[here].part && !std::isnan(lights[other].u);
  };
  const std::size_t from = is_like(before) ? before : here;
  const std::size_t to = is_like(after) ? after : here;
  const double steps = (from != here ? 1.0 : 0.0) + (to != here ? 1.0 : 0.0);
  if (steps == 0.0) return Eigen::Vector2d::Zero();
  return Eigen::Vector2d(static_cast<double>(lights[to].u) - static_cast<double>(lights[from].u),
                         static_cast<double>(lights[to].v) - static_cast<double>(lights[from].v)) /
         steps;
}

/// Symmetric square root of a covariance, in closed form: (C + sqrt(det C) 1) / sqrt(trace C + 2 sqrt(det C)).
Eigen::Matrix2d root_of(const Eigen::Matrix2d& covariance) {
  const double s = std::sqrt(std::max(covariance.determinant(), 0.0));
  const double t = std::sqrt(covariance.trace() + 2.0 * s);
  if (!(t > 0.0)) return Eigen::Matrix2d::Zero();
  return (covariance + s * Eigen::Matrix2d::Identity()) / t;
}

CameraTable::Projector gather(const Grid& grid, const std::vector<Light>& lights,
                              const std::vector<CameraTable::Place>& positions) {
  CameraTable::Projector made;
  for (int y = 0; y < grid.height; ++y) {
    made.row_begins.push_back(made.samples.size());
    for (int x = 0; x < grid.width; ++x) {
      const std::size_t here = grid.at(x, y);
      const Light& light = lights[here];
      if (std::isnan(light.u)) continue;
      const Eigen::Vector2d across =
          slope(lights, positions, here, grid.at(std::max(x - 1, 0), y), grid.at(std::min(x + 1, grid.width - 1), y));
      const Eigen::Vector2d down =
          slope(lights, positions, here, grid.at(x, std::max(y - 1, 0)), grid.at(x, std::min(y + 1, grid.height - 1)));
      const double defocus = static_cast<double>(light.defocus_px);
      // The centres of a unit square's quarters have a variance of 1/16 in each dimension.
      const Eigen::Matrix2d root = root_of((across * across.transpose() + down * down.transpose()) / 16.0 +
                                           defocus * defocus * Eigen::Matrix2d::Identity());
      made.samples.push_back({static_cast<std::uint32_t>(here), light.u, light.v, static_cast<float>(root(0, 0)),
                              static_cast<float>(root(0, 1)), static_cast<float>(root(1, 1)), light.gain_lux});
    }
  }
  made.row_begins.push_back(made.samples.size());
  return made;
}

bool is_near(const Pinhole& lens, const Eigen::Vector2d& pixel) {
  return pixel.x() > -kLightMargin_px && pixel.x() < lens.width_px + kLightMargin_px && pixel.y() > -kLightMargin_px &&
         pixel.y() < lens.height_px + kLightMargin_px;
}

}  // namespace

std::vector<Eigen::Vector3d> pixel_directions(const TrueLens& lens, int threads) {
  const Grid grid{lens.pinhole().width_px, lens.pinhole().height_px};
  std::vector<Eigen::Vector3d> directions(grid.at(0, grid.height), Eigen::Vector3d::Zero());
  for_rows(grid.height, threads, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      for (int x = 0; x < grid.width; ++x) {
        if (const auto direction = lens.direction_at(x + 0.5, y + 0.5)) directions[grid.at(x, y)] = *direction;
      }
    }
  });
  return directions;
}

CameraTable make_camera_table(const TrueMuseum& museum, const TrueLens& lens,
                              const RigidTransform<frame::Room, frame::Camera>& T_room_camera,
                              const std::vector<Eigen::Vector3d>& directions, int threads) {
  const Grid grid{lens.pinhole().width_px, lens.pinhole().height_px};
  CameraTable table;
  table.positions.resize(directions.size());
  std::vector<std::vector<Light>> lights(museum.truth().projectors.size(), std::vector<Light>(directions.size()));
  const Eigen::Matrix3d R_room_camera = T_room_camera.rotation().toRotationMatrix();
  for_rows(grid.height, threads, [&](int begin, int end) {
    for (std::size_t pixel = grid.at(0, begin); pixel < grid.at(0, end); ++pixel) {
      if (!(directions[pixel].z() > 0.0)) continue;
      const auto at = museum.wall().hit({{T_room_camera.translation()}, R_room_camera * directions[pixel]});
      if (!at) continue;
      table.positions[pixel] = {static_cast<std::int32_t>(at->position.part), static_cast<float>(at->position.across),
                                static_cast<float>(at->position.along)};
      const WallPaint& paint = museum.truth().paint;
      if (!paint.is_plain()) table.positions[pixel].paint = static_cast<float>(paint.albedo_at(*at));
      for (std::size_t i = 0; i < lights.size(); ++i) {
        const auto lit = museum.projector_pixel(i, *at);
        if (!lit || !is_near(museum.truth().projectors[i].lens.pinhole(), *lit)) continue;
        const Eigen::Vector3d& source = museum.truth().projectors[i].T_room_projector.translation();
        const double seen = paint.seen_at(*at, source, T_room_camera.translation());
        lights[i][pixel] = {static_cast<float>(lit->x()), static_cast<float>(lit->y()),
                            static_cast<float>(seen * museum.gain_lux(i, *at)),
                            static_cast<float>(museum.defocus_px(i, *at))};
      }
    }
  });
  table.projectors.resize(lights.size());
  for_rows(static_cast<int>(lights.size()), threads, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const auto index = static_cast<std::size_t>(i);
      table.projectors[index] = gather(grid, lights[index], table.positions);
    }
  });
  return table;
}

}  // namespace cyclorama::simulated
