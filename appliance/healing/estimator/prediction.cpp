// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/estimator/prediction.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/check.h"

namespace cyclorama::healing {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr float kMinGain = 1e-6f;

std::size_t index_of(int x, int y, int width) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
}

void add_normals(const Eigen::Vector3f& eye, SeenWall* seen) {
  seen->normals.assign(seen->points.size(), Eigen::Vector3f::Constant(kNone));
  for (int y = 0; y + 1 < seen->height; ++y) {
    for (int x = 0; x + 1 < seen->width; ++x) {
      const std::size_t here = index_of(x, y, seen->width);
      const Eigen::Vector3f right = seen->points[here + 1] - seen->points[here];
      const Eigen::Vector3f down = seen->points[here + static_cast<std::size_t>(seen->width)] - seen->points[here];
      Eigen::Vector3f normal = right.cross(down).normalized();
      if (normal.dot(eye - seen->points[here]) < 0.0f) normal = -normal;
      seen->normals[here] = normal;
    }
  }
}

}  // namespace

CameraSlopes camera_slopes(const calibration::ShowCamera& camera, int factor) {
  CHECK(factor >= 1);
  CameraSlopes made{factor, camera.lens.width_px / factor, camera.lens.height_px / factor, {}};
  made.slopes.reserve(index_of(0, made.height, made.width));
  for (int y = 0; y < made.height; ++y) {
    for (int x = 0; x < made.width; ++x) {
      const auto slope = calibration::slope_at(camera.lens, {(x + 0.5) * factor, (y + 0.5) * factor});
      made.slopes.push_back(slope ? slope->cast<float>().eval() : Eigen::Vector2f::Constant(kNone));
    }
  }
  return made;
}

SeenWall seen_wall(const Wall& wall, const calibration::ShowCamera& camera, const CameraSlopes& slopes) {
  SeenWall seen{slopes.width, slopes.height, {}, {}};
  seen.points.reserve(slopes.slopes.size());
  const Point<frame::Room> eye{camera.T_room_camera.translation()};
  const Eigen::Matrix3d R = camera.T_room_camera.rotation().toRotationMatrix();
  for (const Eigen::Vector2f& slope : slopes.slopes) {
    const auto point =
        std::isnan(slope.x())
            ? std::nullopt
            : hit(wall,
                  {eye, R * Eigen::Vector3d(static_cast<double>(slope.x()), static_cast<double>(slope.y()), 1.0)});
    seen.points.push_back(point ? point->xyz.cast<float>().eval() : Eigen::Vector3f::Constant(kNone));
  }
  add_normals(eye.xyz.cast<float>(), &seen);
  return seen;
}

LitPart lit_part(const SeenWall& seen, const calibration::ShowProjector& projector) {
  LitPart lit;
  lit.positions.resize(seen.points.size());
  lit.first_row = seen.height;
  lit.is_placed = projector.unplaced.empty();
  const RigidTransform<frame::Projector, frame::Room> T = projector.T_room_projector.inverse();
  const Eigen::Matrix3f R = T.rotation().toRotationMatrix().cast<float>();
  const Eigen::Vector3f t = T.translation().cast<float>();
  const Eigen::Vector3f lamp = projector.T_room_projector.translation().cast<float>();
  std::array<float, calibration::kBrownValues> lens{};
  std::ranges::transform(calibration::to_block(projector.lens), lens.begin(),
                         [](double v) { return static_cast<float>(v); });
  const auto width = static_cast<float>(projector.lens.width_px);
  const auto height = static_cast<float>(projector.lens.height_px);
  // The distortion model is not valid far outside of the picture.
  const float widest = 1.2f * std::hypot(width, height) / static_cast<float>(projector.lens.focal_u_px);
  for (std::size_t i = 0; i < lit.positions.size(); ++i) {
    const Eigen::Vector3f p = R * seen.points[i] + t;
    if (!(p.z() > 0.05f)) continue;
    const float x = p.x() / p.z();
    const float y = p.y() / p.z();
    if (!(std::abs(x) < widest && std::abs(y) < widest)) continue;
    float u = 0.0f;
    float v = 0.0f;
    const auto focal_u = lens[calibration::kFocalU];
    const auto focal_v = lens[calibration::kFocalV];
    const float rr = x * x + y * y;
    const float radial =
        1.0f + rr * (lens[calibration::kK1] + rr * (lens[calibration::kK2] + rr * lens[calibration::kK3]));
    u = focal_u * (x * radial + lens[calibration::kP1] * 2.0f * x * y + lens[calibration::kP2] * (rr + 2.0f * x * x)) +
        lens[calibration::kCentreU];
    v = focal_v * (y * radial + lens[calibration::kP1] * (rr + 2.0f * y * y) + lens[calibration::kP2] * 2.0f * x * y) +
        lens[calibration::kCentreV];
    if (!(u > -2.0f && v > -2.0f && u < width + 2.0f && v < height + 2.0f)) continue;
    const Eigen::Vector3f away = lamp - seen.points[i];
    const float distance = away.norm();
    const float facing = seen.normals[i].dot(away) / distance;
    if (!(facing > 0.0f)) continue;
    lit.positions[i] = {u, v, facing / (distance * distance) * std::pow(1.0f + rr, 1.5f)};
    const int row = static_cast<int>(i / static_cast<std::size_t>(seen.width));
    lit.first_row = std::min(lit.first_row, row);
    lit.end_row = row + 1;
  }
  return lit;
}

double footprint_px(const SeenWall& seen, const LitPart& lit) {
  std::vector<float> steps;
  for (int y = 0; y < seen.height; y += 8) {
    for (int x = 0; x + 1 < seen.width; x += 8) {
      const LitPart::Place& here = lit.positions[index_of(x, y, seen.width)];
      const LitPart::Place& next = lit.positions[index_of(x + 1, y, seen.width)];
      if (here.gain > 0.0f && next.gain > 0.0f) steps.push_back(std::hypot(next.u - here.u, next.v - here.v));
    }
  }
  if (steps.empty()) return 1.0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  return static_cast<double>(*middle);
}

Prediction predict(const SeenWall& seen, std::span<const LitPart> lit, std::span<const LightPlane> shone, int factor) {
  CHECK(lit.size() == shone.size());
  Prediction made{{factor, Image<float, 1>(seen.width, seen.height)},
                  Image<std::int8_t, 1>(seen.width, seen.height, kUnlit)};
  Image<float, 1> max(seen.width, seen.height);
  for (std::size_t i = 0; i < lit.size(); ++i) {
    if (shone[i].light.empty()) continue;
    const float scale = 1.0f / static_cast<float>(shone[i].factor);
    for (std::size_t k = index_of(0, lit[i].first_row, seen.width); k < index_of(0, lit[i].end_row, seen.width); ++k) {
      const LitPart::Place& position = lit[i].positions[k];
      if (!(position.gain > kMinGain)) continue;
      const float light = position.gain * shone[i].at(scale * position.u, scale * position.v);
      made.light.light.data()[k] += light;
      if (light > max.data()[k]) {
        max.data()[k] = light;
        made.owner.data()[k] = static_cast<std::int8_t>(i);
      }
    }
  }
  for (std::size_t k = 0; k < seen.points.size(); ++k) {
    std::int8_t& owner = made.owner.data()[k];
    if (std::isnan(seen.points[k].x())) {
      owner = kBesideWall;
    } else if (owner >= 0 && (!lit[static_cast<std::size_t>(owner)].is_placed ||
                              max.data()[k] < kOwnShare * made.light.light.data()[k])) {
      owner = kOverlap;
    }
  }
  soften(&made.light);
  return made;
}

}  // namespace cyclorama::healing
