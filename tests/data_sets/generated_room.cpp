// SPDX-License-Identifier: Apache-2.0
#include "tests/data_sets/generated_room.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace cyclorama {
namespace {

constexpr double kUsualWidth_px = 1920.0;
constexpr double kUsualMegapixels = 2.304;

double gauss(std::mt19937* random) {
  std::normal_distribution<double> normal;
  return normal(*random);
}
double uniform(std::mt19937* random, double min, double max) {
  return std::uniform_real_distribution<double>(min, max)(*random);
}

std::function<double(const Eigen::Vector3d&)> wall_of(const RoomPlan& plan, std::mt19937* random) {
  const double r = plan.radius_m;
  switch (plan.kind) {
    case RoomKind::kPlane: {
      const double pan = uniform(random, -0.1, 0.1);
      const double tilt = uniform(random, -0.06, 0.06);
      const Eigen::Vector3d n = Eigen::Vector3d(std::sin(pan), std::sin(tilt), std::cos(pan)).normalized();
      return [=](const Eigen::Vector3d& p) { return n.dot(p) + r; };
    }
    case RoomKind::kCorner: {
      const double turn = uniform(random, -0.15, 0.15);
      const double half = uniform(random, 0.75, 0.95);  // Half of the angle between the planes.
      const auto normal = [&](double side) {
        const double a = turn + side * (0.5 * std::numbers::pi - half);
        return Eigen::Vector3d(-std::sin(a), 0.0, std::cos(a));
      };
      const Eigen::Vector3d left = normal(-1.0);
      const Eigen::Vector3d right = normal(1.0);
      const double distance = r * std::sin(half);
      return [=](const Eigen::Vector3d& p) { return std::min(left.dot(p), right.dot(p)) + distance; };
    }
    case RoomKind::kDome: {
      const Eigen::Vector3d centre(uniform(random, -0.2, 0.2), uniform(random, -0.4, 0.2), uniform(random, -0.2, 0.2));
      return [=](const Eigen::Vector3d& p) { return r - (p - centre).norm(); };
    }
    case RoomKind::kCylinder:
    case RoomKind::kTiltedCylinder:
    case RoomKind::kUnevenCylinder:
    case RoomKind::kBumpy:
      break;
  }
  const double tilt = plan.kind == RoomKind::kTiltedCylinder ? uniform(random, 0.04, 0.09) : 0.0;
  const double towards = uniform(random, -std::numbers::pi, std::numbers::pi);
  const Eigen::Matrix3d turned =
      Eigen::AngleAxisd(tilt, Eigen::Vector3d(std::cos(towards), 0.0, std::sin(towards))).toRotationMatrix();
  const Eigen::Vector3d centre(uniform(random, -0.15, 0.15), 0.0, uniform(random, -0.15, 0.15));
  if (plan.kind == RoomKind::kUnevenCylinder) {
    const double phase = uniform(random, 0.0, 6.28);
    const double waves = uniform(random, 1.2, 2.2);
    return [=](const Eigen::Vector3d& p) {  // 4.06 to 4.6 m along the arc, as measured in a real room.
      const Eigen::Vector3d q = p - centre;
      const double a = std::atan2(q.x(), -q.z());
      return (r / 4.0) * (4.33 + 0.27 * std::sin(waves * a + phase)) - std::hypot(q.x(), q.z());
    };
  }
  if (plan.kind == RoomKind::kBumpy) {
    struct Bump {
      double azimuth, height, amount, width;
    };
    std::vector<Bump> bumps;
    for (int i = 0; i < 24; ++i) {
      bumps.push_back({uniform(random, -1.2, 1.2), uniform(random, -1.4, 1.4), uniform(random, -0.04, 0.04),
                       uniform(random, 0.35, 0.6)});
    }
    return [=](const Eigen::Vector3d& p) {
      const Eigen::Vector3d q = p - centre;
      const double a = std::atan2(q.x(), -q.z());
      double radius = r;
      for (const Bump& bump : bumps) {
        const double d = std::hypot(r * (a - bump.azimuth), q.y() - bump.height) / bump.width;
        radius += bump.amount * std::exp(-d * d);
      }
      return radius - std::hypot(q.x(), q.z());
    };
  }
  return [=](const Eigen::Vector3d& p) {
    const Eigen::Vector3d q = turned * (p - centre);
    return r - std::hypot(q.x(), q.z());
  };
}

/// Axes of a device that looks along `forward` with its picture upright.
Eigen::Matrix3d axes_towards(const Eigen::Vector3d& forward, double roll) {
  const Eigen::Vector3d f = forward.normalized();
  const Eigen::Vector3d right = f.cross(Eigen::Vector3d::UnitY()).normalized();
  Eigen::Matrix3d axes;
  axes << right, f.cross(right), f;
  return axes * Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

double at_fraction(std::vector<double>* sorted, double fraction) {
  if (sorted->empty()) return 0.0;
  std::sort(sorted->begin(), sorted->end());
  return (
      *sorted)[std::min(sorted->size() - 1, static_cast<std::size_t>(fraction * static_cast<double>(sorted->size())))];
}

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

}  // namespace

const char* name_of(RoomKind kind) {
  switch (kind) {
    case RoomKind::kPlane:
      return "plane";
    case RoomKind::kCylinder:
      return "cylinder";
    case RoomKind::kTiltedCylinder:
      return "tilted";
    case RoomKind::kUnevenCylinder:
      return "uneven";
    case RoomKind::kCorner:
      return "corner";
    case RoomKind::kDome:
      return "dome";
    case RoomKind::kBumpy:
      return "bumpy";
  }
  return "";
}

GeneratedRoom::GeneratedRoom(const RoomPlan& plan) : plan_(plan) {
  std::mt19937 random(plan.seed * 7919U + static_cast<unsigned>(plan.kind));
  before_ = wall_of(plan, &random);
  pitch_ = uniform(&random, -0.03, 0.03);
  roll_ = uniform(&random, -0.03, 0.03);
  const double scale = std::sqrt(plan.camera_megapixels / kUsualMegapixels);
  camera_width_px_ = static_cast<int>(std::lround(kUsualWidth_px * scale));
  camera_height_px_ = static_cast<int>(std::lround(kUsualWidth_px * 0.625 * scale));
  camera_lens_.focal_px = 1400.0 * scale * uniform(&random, 0.98, 1.02);
  camera_lens_.centre_u_px = 0.5 * camera_width_px_ + scale * uniform(&random, -10.0, 10.0);
  camera_lens_.centre_v_px = 0.5 * camera_height_px_ + scale * uniform(&random, -10.0, 10.0);
  camera_lens_.k1 = -0.09;
  camera_lens_.k2 = 0.02;
  const int steps = static_cast<int>(
      std::ceil(std::max(0.5 * plan.turntable_step_rad, 0.5 * plan.arc_rad - 0.3) / plan.turntable_step_rad));
  for (int i = -steps; i <= steps; ++i) {
    const double angle = i * plan.turntable_step_rad;
    if (angle > std::numbers::pi || angle <= -std::numbers::pi) continue;
    told_angles_.push_back(angle);
    angles_.push_back(angle + (i == 0 ? 0.0 : plan.turntable_sigma_rad * gauss(&random)));
  }
  place_projectors(&random);
}

void GeneratedRoom::place_projectors(std::mt19937* random) {
  const double each = plan_.arc_rad / plan_.projectors;
  for (int i = 0; i < plan_.projectors; ++i) {
    const double azimuth = -0.5 * plan_.arc_rad + (i + 0.5) * each;
    const auto wall_at = [&](double a) -> Eigen::Vector3d {
      const Eigen::Vector3d d(std::sin(a), 0.0, -std::cos(a));
      const auto point = hit(Eigen::Vector3d::Zero(), d);
      return point ? *point : Eigen::Vector3d(plan_.radius_m * d);
    };
    const double half = 0.5 * each * (1.0 + plan_.overlap);
    const Eigen::Vector3d aim = wall_at(azimuth);
    const Eigen::Vector3d left = wall_at(azimuth - half);
    const Eigen::Vector3d right = wall_at(azimuth + half);
    Device device;
    if (plan_.throw_ratio > 0.0) {
      const Eigen::Vector3d back = Eigen::Vector3d::UnitY().cross(left - right).normalized();
      const Eigen::Vector3d towards = back.dot(aim) > 0.0 ? Eigen::Vector3d(-back) : back;
      const double away = plan_.throw_ratio * (right - left).norm();
      const Eigen::Vector3d aside = plan_.aim_off_rad * away * (right - left).normalized();
      device.position = aim + away * towards + aside + Eigen::Vector3d(0.0, 0.12 * away, 0.0);
    } else {
      const Eigen::Vector3d d = aim.normalized();
      device.position = -0.3 * d + Eigen::Vector3d(-0.8 * d.z() * uniform(random, 0.6, 1.0), uniform(random, 0.9, 1.4),
                                                   0.8 * d.x() * uniform(random, 0.6, 1.0));
    }
    device.axes = axes_towards(aim - device.position, uniform(random, -0.02, 0.02));
    double widest = 0.0;
    for (const Eigen::Vector3d& edge : {left, right}) {
      const Eigen::Vector3d seen = device.axes.transpose() * (edge - device.position);
      widest = std::max(widest, std::abs(seen.x()) / std::max(0.02, seen.z()));
    }
    device.lens = {0.5 * kWidth_px / widest, 0.5 * kWidth_px + uniform(random, -15.0, 15.0),
                   0.5 * kHeight_px + uniform(random, -15.0, 15.0), plan_.projector_k1 * uniform(random, 0.5, 1.0),
                   0.0};
    // A wide lens gets less distortion, since its edge would fold otherwise.
    device.lens.k1 /= 1.0 + widest * widest;
    projectors_.push_back(device);
  }
}

Eigen::Vector2d GeneratedRoom::through(const Lens& lens, const Eigen::Vector3d& point) {
  const Eigen::Vector2d t = point.head<2>() / point.z();
  const double r2 = t.squaredNorm();
  return lens.focal_px * (1.0 + lens.k1 * r2 + lens.k2 * r2 * r2) * t +
         Eigen::Vector2d(lens.centre_u_px, lens.centre_v_px);
}

Eigen::Vector3d GeneratedRoom::ray_of(const Lens& lens, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d target = (pixel - Eigen::Vector2d(lens.centre_u_px, lens.centre_v_px)) / lens.focal_px;
  const double wanted = target.norm();
  if (wanted < 1e-12) return {0.0, 0.0, 1.0};
  double low = 0.0;
  double high = 2.0 * wanted;
  for (int i = 0; i < 60; ++i) {
    const double r = 0.5 * (low + high);
    (r * (1.0 + lens.k1 * r * r + lens.k2 * r * r * r * r) < wanted ? low : high) = r;
  }
  const Eigen::Vector2d t = target * (0.5 * (low + high) / wanted);
  return {t.x(), t.y(), 1.0};
}

std::optional<Eigen::Vector3d> GeneratedRoom::hit(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) const {
  const Eigen::Vector3d d = direction.normalized();
  const double step = 0.15 * plan_.radius_m / 4.0;
  double last = before_(from);
  for (double t = step; t < 12.0 * plan_.radius_m; t += step) {
    const double now = before_(from + t * d);
    if (last > 0.0 && now <= 0.0) {
      double low = t - step;
      double high = t;
      for (int i = 0; i < 44; ++i) {
        const double middle = 0.5 * (low + high);
        (before_(from + middle * d) > 0.0 ? low : high) = middle;
      }
      return Eigen::Vector3d(from + 0.5 * (low + high) * d);
    }
    last = now;
  }
  return std::nullopt;
}

std::optional<Eigen::Vector3d> GeneratedRoom::wall_point_of(std::size_t projector, const Eigen::Vector2d& pixel) const {
  const Device& device = projectors_[projector];
  const auto point = hit(device.position, device.axes * ray_of(device.lens, pixel));
  if (!point || std::abs(point->y()) > plan_.half_height_m) return std::nullopt;
  const double azimuth = std::atan2(point->x(), -point->z());
  constexpr double kMargin_rad = 0.02;
  if (std::abs(azimuth) > 0.5 * plan_.arc_rad * (1.0 + 1e-9) + kMargin_rad) return std::nullopt;
  return point;
}

std::optional<Eigen::Vector3d> GeneratedRoom::view_direction_of(std::size_t projector,
                                                                const Eigen::Vector2d& pixel) const {
  const auto point = wall_point_of(projector, pixel);
  if (!point) return std::nullopt;
  return point->normalized();
}

std::optional<Eigen::Vector2d> GeneratedRoom::pixel_lighting(std::size_t projector,
                                                             const Eigen::Vector3d& point) const {
  const Device& device = projectors_[projector];
  const Eigen::Vector3d seen = device.axes.transpose() * (point - device.position);
  if (!(seen.z() > 0.05)) return std::nullopt;
  const Eigen::Vector2d pixel = through(device.lens, seen);
  if (!(pixel.x() >= 0.0 && pixel.x() <= kWidth_px && pixel.y() >= 0.0 && pixel.y() <= kHeight_px)) return std::nullopt;
  // The ray may meet another part of the wall first, or a fold of the lens may have produced this pixel.
  const auto lit = wall_point_of(projector, pixel);
  if (!lit || (*lit - point).norm() > 1e-3) return std::nullopt;
  return pixel;
}

GeneratedRoom::Device GeneratedRoom::camera_at(double angle_rad) const {
  const Eigen::Vector3d heading(std::sin(angle_rad), 0.0, -std::cos(angle_rad));
  const Eigen::Vector3d right(std::cos(angle_rad), 0.0, std::sin(angle_rad));
  const Eigen::Vector3d up = Eigen::Vector3d::UnitY();
  Device device;
  device.position = plan_.camera_offset_m.x() * right + plan_.camera_offset_m.z() * heading;
  const Eigen::Vector3d forward = std::cos(pitch_) * heading + std::sin(pitch_) * up;
  const Eigen::Vector3d upwards = right.cross(forward);
  // The roll tilts the camera's right axis downwards.
  device.axes << std::cos(roll_) * right + std::sin(roll_) * -upwards,
      -(std::cos(roll_) * upwards + std::sin(roll_) * right), forward;
  device.lens = camera_lens_;
  return device;
}

solve::Measurements GeneratedRoom::measurements() const {
  std::mt19937 random(plan_.seed * 104729U + 13U);
  solve::Measurements measured;
  measured.camera = calibration::MeasuredLens::from_focal(camera_width_px_, camera_height_px_, camera_lens_.focal_px);
  // Residual errors of a good chessboard calibration.
  const double sigmas[] = {0.7, 0.7, 0.7, 5e-4, 5e-4, 1e-6, 1e-5, 1e-5};
  const double truth[] = {camera_lens_.focal_px,
                          camera_lens_.centre_u_px,
                          camera_lens_.centre_v_px,
                          camera_lens_.k1,
                          camera_lens_.k2,
                          0.0,
                          0.0,
                          0.0};
  measured.camera.covariance.setZero();
  for (std::size_t i = 0; i < 8; ++i) {
    measured.camera.values[i] = truth[i] + (i < 5 ? plan_.camera_lens_error * sigmas[i] * gauss(&random) : 0.0);
    const auto row = static_cast<Eigen::Index>(i);
    measured.camera.covariance(row, row) = sigmas[i] * sigmas[i];
  }
  measured.wall_distance_m = plan_.radius_m * uniform(&random, 0.95, 1.05);
  measured.wall_distance_sigma_m = 0.25 * plan_.radius_m;
  const Eigen::Matrix3d eye_axes = Eigen::Matrix3d::Identity();
  for (std::size_t p = 0; p < projectors_.size(); ++p) {
    const Device& device = projectors_[p];
    solve::ProjectorPosePrior position;
    position.lens = calibration::MeasuredLens::from_focal(kWidth_px, kHeight_px,
                                                          device.lens.focal_px * uniform(&random, 0.97, 1.03));
    const Eigen::Matrix3d off =
        Eigen::AngleAxisd(0.03, Eigen::Vector3d(gauss(&random), gauss(&random), gauss(&random)).normalized())
            .toRotationMatrix();
    position.T_eye_projector = {
        Eigen::Quaterniond(eye_axes * off * device.axes),
        device.position + 0.1 * Eigen::Vector3d(gauss(&random), gauss(&random), gauss(&random))};
    measured.projectors.push_back({"projector " + std::to_string(p + 1), kWidth_px, kHeight_px, position});
  }
  std::vector<Device> cameras;
  for (std::size_t d = 0; d < told_angles_.size(); ++d) {
    measured.directions.push_back({told_angles_[d], plan_.turntable_sigma_rad, {}});
    cameras.push_back(camera_at(angles_[d]));
  }
  for (std::size_t p = 0; p < projectors_.size(); ++p) {
    for (int y = 0; y < kHeight_px; y += plan_.stride_px) {
      for (int x = 0; x < kWidth_px; x += plan_.stride_px) {
        const Eigen::Vector2d pixel(x + uniform(&random, 0.0, plan_.stride_px),
                                    y + uniform(&random, 0.0, plan_.stride_px));
        const auto point = pixel.x() < kWidth_px && pixel.y() < kHeight_px ? wall_point_of(p, pixel) : std::nullopt;
        if (!point) continue;
        for (std::size_t d = 0; d < cameras.size(); ++d) {
          const Eigen::Vector3d seen = cameras[d].axes.transpose() * (*point - cameras[d].position);
          if (!(seen.z() > 0.05) || seen.head<2>().norm() > 1.2 * seen.z()) continue;
          const Eigen::Vector2d camera_px = through(cameras[d].lens, seen);
          if (!(camera_px.x() >= 0.0 && camera_px.x() < camera_width_px_ && camera_px.y() >= 0.0 &&
                camera_px.y() < camera_height_px_)) {
            continue;
          }
          Eigen::Vector2d told = pixel + plan_.noise_px * Eigen::Vector2d(gauss(&random), gauss(&random));
          if (uniform(&random, 0.0, 1.0) < plan_.outliers) {
            told = {uniform(&random, 0.0, kWidth_px), uniform(&random, 0.0, kHeight_px)};
          }
          // A person hides a different part in each direction; a code with wrong coarse bits is off by many pixels.
          if (plan_.person_rad > 0.0) {
            const double at = told_angles_[d] + 0.4 * std::sin(3.0 * static_cast<double>(d) + 1.0);
            const double aside = std::atan2(point->x(), -point->z()) - at;
            if (std::abs(aside) < 0.5 * plan_.person_rad && uniform(&random, 0.0, 1.0) < 0.5) {
              told += Eigen::Vector2d(uniform(&random, -200.0, 200.0), uniform(&random, -200.0, 200.0));
            }
          }
          measured.directions[d].correspondences.push_back(
              {static_cast<float>(camera_px.x()), static_cast<float>(camera_px.y()), static_cast<float>(told.x()),
               static_cast<float>(told.y()), static_cast<float>(std::max(0.02, plan_.noise_px)),
               static_cast<std::uint32_t>(p)});
        }
      }
    }
  }
  return measured;
}

RegistrationScore registration_score(const GeneratedRoom& room, const DirectionOf& mapped) {
  struct Place {
    std::size_t projector;
    Eigen::Vector2d pixel;
    Eigen::Vector3d point, truth, found;
    Eigen::Matrix<double, 3, 2> slope;
  };
  RegistrationScore score;
  std::vector<Place> correspondences;
  Eigen::Matrix3d together = Eigen::Matrix3d::Zero();
  constexpr int kStep_px = 24;
  const auto slope_at = [&](std::size_t p, const Eigen::Vector2d& pixel) -> std::optional<Eigen::Matrix<double, 3, 2>> {
    Eigen::Matrix<double, 3, 2> slope;
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d step = Eigen::Vector2d::Unit(axis);
      const auto a = room.view_direction_of(p, pixel - 0.5 * step);
      const auto b = room.view_direction_of(p, pixel + 0.5 * step);
      if (!a || !b) return std::nullopt;
      slope.col(axis) = *b - *a;
    }
    return slope;
  };
  const auto in_pixels = [](const Eigen::Matrix<double, 3, 2>& slope, const Eigen::Vector3d& error) {
    return (slope.transpose() * slope).ldlt().solve(slope.transpose() * error).norm();
  };
  for (std::size_t p = 0; p < room.projectors(); ++p) {
    for (int y = kStep_px / 2; y < GeneratedRoom::kHeight_px; y += kStep_px) {
      for (int x = kStep_px / 2; x < GeneratedRoom::kWidth_px; x += kStep_px) {
        const Eigen::Vector2d pixel(x + 0.37, y + 0.61);
        const auto point = room.wall_point_of(p, pixel);
        const auto slope = slope_at(p, pixel);
        if (!point || !slope) continue;
        ++score.lit;
        const auto found = mapped(p, pixel);
        if (!found || !found->allFinite()) {
          ++score.missing;
          continue;
        }
        correspondences.push_back({p, pixel, *point, point->normalized(), *found, *slope});
        together += *found * point->normalized().transpose();
      }
    }
  }
  if (correspondences.empty()) return score;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(together, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs(1.0, 1.0, (svd.matrixV() * svd.matrixU().transpose()).determinant() < 0.0 ? -1.0 : 1.0);
  const Eigen::Matrix3d turn = svd.matrixV() * signs.asDiagonal() * svd.matrixU().transpose();
  std::vector<double> relative;
  std::vector<double> absolute;
  for (const Place& position : correspondences) {
    absolute.push_back(in_pixels(position.slope, turn * position.found - position.truth));
    for (std::size_t other = position.projector + 1; other < room.projectors(); ++other) {
      const auto pixel = room.pixel_lighting(other, position.point);
      const auto slope = pixel ? slope_at(other, *pixel) : std::nullopt;
      const auto found = pixel ? mapped(other, *pixel) : std::nullopt;
      if (!slope || !found) continue;
      relative.push_back(in_pixels(*slope, position.found - *found));
    }
  }
  score.correspondences = relative.size();
  score.mean_px = mean_of(relative);
  score.p95_px = at_fraction(&relative, 0.95);
  score.max_px = relative.empty() ? 0.0 : relative.back();
  score.true_mean_px = mean_of(absolute);
  score.true_p95_px = at_fraction(&absolute, 0.95);
  score.true_max_px = absolute.empty() ? 0.0 : absolute.back();
  return score;
}

}  // namespace cyclorama
