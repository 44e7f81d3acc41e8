// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/simulated_show.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "common/base/check.h"
#include "drivers/simulated/museum/gaussian_blur.h"
#include "drivers/simulated/museum/parallel_rows.h"

namespace cyclorama::simulated {
namespace {

struct Touch {
  double along = 0.0;  ///< Distance in lengths of the direction.
  const Visitor* who = nullptr;
};

/// Returns the first visitor that a ray from `origin` along `direction` hits, within `far` times the length of
/// `direction`.
std::optional<Touch> touch(std::span<const Visitor> visitors, const Eigen::Vector3d& origin,
                           const Eigen::Vector3d& direction, double far) {
  std::optional<Touch> first;
  for (const Visitor& who : visitors) {
    const Eigen::Vector2d from(origin.x() - who.x_m, origin.z() - who.z_m);
    const Eigen::Vector2d way(direction.x(), direction.z());
    const double a = way.squaredNorm();
    const double b = from.dot(way);
    const double c = from.squaredNorm() - who.radius_m * who.radius_m;
    const double inside = b * b - a * c;
    if (!(inside > 0.0) || !(a > 0.0)) continue;
    const double along = (-b - std::sqrt(inside)) / a;
    const double height = origin.y() + along * direction.y();
    if (!(along > 1e-6 && along < far && height > 0.0 && height < who.height_m)) continue;
    if (!first || along < first->along) first = Touch{along, &who};
  }
  return first;
}

}  // namespace

SimulatedShow::SimulatedShow(TrueMuseum museum, std::vector<FixedCamera> cameras, int threads)
    : museum_(std::move(museum)),
      cameras_(std::move(cameras)),
      lights_(museum_.truth().projectors.size()),
      ambient_lux_(museum_.truth().ambient_lux),
      threads_(std::max(threads, 1)) {
  for (const FixedCamera& camera : cameras_) {
    Eye eye{pixel_directions(camera.optics.lens, threads_), {}, TrueSensor(camera.optics), {}, {}};
    for (const Eigen::Vector3d& d : eye.directions) {
      const double cosine = d.z() > 0.0 ? d.z() / d.norm() : 0.0;
      eye.vignetting.push_back(static_cast<float>(std::pow(cosine, camera.optics.vignetting_exponent)));
    }
    eyes_.push_back(std::move(eye));
  }
}

Result<SimulatedShow> SimulatedShow::make(Installation installation, MuseumTruth truth,
                                          std::vector<FixedCamera> cameras, int threads) {
  TRY_ASSIGN(TrueMuseum museum, TrueMuseum::make(std::move(installation), std::move(truth)));
  for (const FixedCamera& camera : cameras) {
    if (!is_lit_from(museum.truth().wall,
                     museum.truth().T_room_wall.inverse() * Point<frame::Room>{camera.T_room_camera.translation()}))
      return Error(ErrorCode::kInvalidArgument, "a camera stands behind the wall");
  }
  return SimulatedShow(std::move(museum), std::move(cameras), threads);
}

Status SimulatedShow::show(std::size_t projector, RgbImage picture) {
  if (projector >= lights_.size()) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("there is no projector {}; there are {}", projector, lights_.size()));
  }
  const Pinhole& lens = museum_.truth().projectors[projector].lens.pinhole();
  if (!picture.empty() && (picture.width() != lens.width_px || picture.height() != lens.height_px)) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("a picture of {}x{} for a projector of {}x{}", picture.width(), picture.height(),
                             lens.width_px, lens.height_px));
  }
  lights_[projector] = ProjectorLight(std::move(picture));
  return Done{};
}

Status SimulatedShow::move_projector(std::size_t projector,
                                     const RigidTransform<frame::Room, frame::Projector>& T_room_projector) {
  CHECK(projector < lights_.size());
  MuseumTruth truth = museum_.truth();
  truth.projectors[projector].T_room_projector = T_room_projector;
  TRY_ASSIGN(museum_, TrueMuseum::make(museum_.installation(), std::move(truth)));
  lights_[projector] = ProjectorLight();
  for (Eye& eye : eyes_) {
    eye.table.reset();
    eye.peopled.reset();
  }
  return Done{};
}

void SimulatedShow::move_camera(std::size_t camera, const RigidTransform<frame::Room, frame::Camera>& T_room_camera) {
  CHECK(camera < cameras_.size());
  cameras_[camera].T_room_camera = T_room_camera;
  eyes_[camera].table.reset();
  eyes_[camera].peopled.reset();
}

void SimulatedShow::set_visitors(std::vector<Visitor> visitors) {
  visitors_ = std::move(visitors);
  for (Eye& eye : eyes_) eye.peopled.reset();
}

const CameraTable& SimulatedShow::table_of(std::size_t camera) {
  Eye& eye = eyes_[camera];
  const FixedCamera& fixed = cameras_[camera];
  if (!eye.table)
    eye.table = make_camera_table(museum_, fixed.optics.lens, fixed.T_room_camera, eye.directions, threads_);
  if (visitors_.empty()) return *eye.table;
  if (!eye.peopled) eye.peopled = with_visitors(*eye.table, camera);
  return *eye.peopled;
}

CameraTable SimulatedShow::with_visitors(const CameraTable& table, std::size_t camera) const {
  const Eye& eye = eyes_[camera];
  const RigidTransform<frame::Room, frame::Camera>& T = cameras_[camera].T_room_camera;
  const auto width = static_cast<std::size_t>(cameras_[camera].optics.lens.pinhole().width_px);
  CameraTable made;
  made.positions = table.positions;
  std::vector<std::optional<TrueWall::Hit>> walls(made.positions.size());
  std::vector<std::optional<Touch>> people(made.positions.size());
  for_rows(static_cast<int>(made.positions.size()), threads_, [&](int begin, int end) {
    for (auto pixel = static_cast<std::size_t>(begin); pixel < static_cast<std::size_t>(end); ++pixel) {
      const CameraTable::Place& position = table.positions[pixel];
      const Eigen::Vector3d direction = T.rotation() * eye.directions[pixel];
      double far = 100.0;
      if (position.part >= 0) {
        walls[pixel] = museum_.wall().at({static_cast<std::size_t>(position.part), static_cast<double>(position.across),
                                          static_cast<double>(position.along)});
        far = (walls[pixel]->point.xyz - T.translation()).norm() / std::max(direction.norm(), 1e-9);
      }
      people[pixel] = touch(visitors_, T.translation(), direction, far);
      if (people[pixel]) made.positions[pixel].part = -1;
    }
  });
  for (std::size_t i = 0; i < table.projectors.size(); ++i) {
    const CameraTable::Projector& before = table.projectors[i];
    CameraTable::Projector& after = made.projectors.emplace_back();
    const TrueProjector& lamp = museum_.truth().projectors[i];
    const Eigen::Vector3d source = lamp.T_room_projector.translation();
    const double wall_albedo = museum_.truth().albedo[1];
    for (std::size_t row = 0; row + 1 < before.row_begins.size(); ++row) {
      after.row_begins.push_back(after.samples.size());
      for (std::size_t k = before.row_begins[row]; k < before.row_begins[row + 1]; ++k) {
        const CameraTable::Sample& s = before.samples[k];
        if (people[s.pixel] || !walls[s.pixel]) continue;
        if (!touch(visitors_, source, walls[s.pixel]->point.xyz - source, 0.999)) after.samples.push_back(s);
      }
      for (std::size_t pixel = row * width; pixel < (row + 1) * width; ++pixel) {
        if (!people[pixel]) continue;
        TrueWall::Hit at;
        at.point.xyz = T.translation() + people[pixel]->along * (T.rotation() * eye.directions[pixel]);
        at.normal = {at.point.xyz.x() - people[pixel]->who->x_m, 0.0, at.point.xyz.z() - people[pixel]->who->z_m};
        at.normal.normalize();
        const auto lit = lamp.lens.pixel_of((lamp.T_room_projector.inverse() * at.point).xyz);
        if (!lit || !lamp.lens.pinhole().contains(*lit)) continue;
        if (touch(visitors_, source, at.point.xyz - source, 0.999)) continue;
        const double gain = museum_.gain_lux(i, at) * people[pixel]->who->albedo / wall_albedo;
        after.samples.push_back({static_cast<std::uint32_t>(pixel), static_cast<float>(lit->x()),
                                 static_cast<float>(lit->y()), 1.0f, 0.0f, 1.0f, static_cast<float>(gain)});
      }
    }
    after.row_begins.push_back(after.samples.size());
  }
  return made;
}

std::vector<float> SimulatedShow::slow_light(const CameraChannel& channel) {
  InterReflection::Light light(museum_.cells().count(), ambient_lux_);
  if (const InterReflection* walls = museum_.inter_reflection()) {
    for (std::size_t i = 0; i < lights_.size(); ++i) {
      if (lights_[i].is_dark()) continue;
      const auto& direct = lights_[i].direct_light(museum_, i);
      for (std::size_t k = 0; k < light.size(); ++k) {
        for (std::size_t r = 0; r < 3; ++r) light[k][r] += direct[k][r];
      }
    }
    light = walls->indirect(light);
    for (RoomColour& lux : light) {
      for (std::size_t r = 0; r < 3; ++r) lux[r] += ambient_lux_[r];
    }
  }
  std::vector<float> seen;
  for (const RoomColour& lux : light) {
    double sum = 0.0;
    for (std::size_t r = 0; r < 3; ++r) sum += channel[r] * museum_.truth().albedo[r] / std::numbers::pi * lux[r];
    seen.push_back(static_cast<float>(sum));
  }
  return seen;
}

Result<GreyImage> SimulatedShow::photograph(std::size_t camera, double exposure_s) {
  if (camera >= cameras_.size() || !(exposure_s > 0.0))
    return Error(ErrorCode::kInvalidArgument, fmt::format("no camera {}, or no exposure", camera));
  const TrueCamera& optics = cameras_[camera].optics;
  const int width = optics.lens.pinhole().width_px;
  const int height = optics.lens.pinhole().height_px;
  const CameraChannel& channel = optics.grey_sensitivity;
  const CameraTable& table = table_of(camera);
  const std::vector<float> cells = slow_light(channel);
  const double surround = museum_.truth().surround_nits * (channel[0] + channel[1] + channel[2]);
  std::vector<float> plane(table.positions.size(), static_cast<float>(surround));
  std::vector<const ProjectorLight::Plane*> shone(lights_.size(), nullptr);
  for (std::size_t i = 0; i < lights_.size(); ++i) {
    if (!lights_[i].is_dark()) shone[i] = &lights_[i].planes(museum_, i, {channel}, threads_).front();
  }
  for_rows(height, threads_, [&](int begin, int end) {
    const auto first = static_cast<std::size_t>(begin) * static_cast<std::size_t>(width);
    const auto last = static_cast<std::size_t>(end) * static_cast<std::size_t>(width);
    for (std::size_t pixel = first; pixel < last; ++pixel) {
      const CameraTable::Place& position = table.positions[pixel];
      if (position.part < 0) continue;
      const auto share =
          museum_.cells().share({static_cast<std::size_t>(position.part), static_cast<double>(position.across),
                                 static_cast<double>(position.along)});
      float light = 0.0f;
      for (std::size_t k = 0; k < 4; ++k) light += static_cast<float>(share.weights[k]) * cells[share.cells[k]];
      plane[pixel] = position.paint * light;
    }
    for (std::size_t i = 0; i < shone.size(); ++i) {
      if (shone[i] == nullptr) continue;
      const CameraTable::Projector& seen = table.projectors[i];
      for (std::size_t k = seen.row_begins[static_cast<std::size_t>(begin)];
           k < seen.row_begins[static_cast<std::size_t>(end)]; ++k) {
        const CameraTable::Sample& s = seen.samples[k];
        const float sum_u = s.uu + s.uv;
        const float sum_v = s.uv + s.vv;
        const float difference_u = s.uu - s.uv;
        const float difference_v = s.uv - s.vv;
        plane[s.pixel] += 0.25f * s.gain_lux *
                          (shone[i]->at(s.u + sum_u, s.v + sum_v) + shone[i]->at(s.u - sum_u, s.v - sum_v) +
                           shone[i]->at(s.u + difference_u, s.v + difference_v) +
                           shone[i]->at(s.u - difference_u, s.v - difference_v));
      }
    }
  });
  blur_plane(&plane, width, height, std::sqrt(optics.blur_px * optics.blur_px + kFootprintLack_px2), threads_);
  const auto electrons = static_cast<float>(optics.electrons_per_nit_s * exposure_s);
  GreyPhotograph codes(width, height);
  for (int y = 0; y < height; ++y) {
    const std::size_t first = static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
    const std::span<float> row(plane.data() + first, static_cast<std::size_t>(width));
    for (std::size_t x = 0; x < row.size(); ++x) row[x] *= electrons * eyes_[camera].vignetting[first + x];
    const std::uint64_t stream =
        mixed(mixed(museum_.truth().seed + 0x20000u) + photographs_ * 0x10000u + static_cast<std::uint64_t>(y));
    eyes_[camera].sensor.read_row(row, stream, codes.at(0, y), 1);
  }
  ++photographs_;
  optics.pipeline.apply(&codes, (1 << optics.bits) - 1);
  return to_8_bits(codes, optics.bits);
}

}  // namespace cyclorama::simulated
