// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibrator/solve/measured_lens.h"

#include <Eigen/LU>
#include <cmath>

namespace cyclorama {
namespace {

constexpr double kInFront = 1e-9;
constexpr int kMostSteps = 60;
constexpr double kConverged = 1e-14;  // Of a tangent: far below 1e-9 px at any focal length.

/// Whether the radial polynomial rises all the way to radius r, so that it can be inverted there.
bool rises_to(const std::array<double, MeasuredLens::kParameters>& lens, double r) {
  constexpr int kSteps = 24;
  for (int i = 1; i <= kSteps; ++i) {
    const double s = r * i / kSteps;
    const double s2 = s * s;
    if (!(1.0 + s2 * (3.0 * lens[MeasuredLens::kK1] +
                      s2 * (5.0 * lens[MeasuredLens::kK2] + 7.0 * s2 * lens[MeasuredLens::kK3])) >
          0.0)) {
      return false;
    }
  }
  return true;
}

struct Distorted {
  Eigen::Vector2d place;
  Eigen::Matrix2d slope;
};

Distorted distorted(const std::array<double, MeasuredLens::kParameters>& lens, double x, double y) {
  const double k1 = lens[MeasuredLens::kK1];
  const double k2 = lens[MeasuredLens::kK2];
  const double k3 = lens[MeasuredLens::kK3];
  const double p1 = lens[MeasuredLens::kP1];
  const double p2 = lens[MeasuredLens::kP2];
  const double r2 = x * x + y * y;
  const double s = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double ds = 2.0 * (k1 + r2 * (2.0 * k2 + 3.0 * r2 * k3));  // By x, over x.
  Distorted d;
  d.place = {x * s + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x), y * s + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
  d.slope(0, 0) = s + x * x * ds + 2.0 * p1 * y + 6.0 * p2 * x;
  d.slope(0, 1) = x * y * ds + 2.0 * p1 * x + 2.0 * p2 * y;
  d.slope(1, 0) = x * y * ds + 2.0 * p1 * x + 2.0 * p2 * y;
  d.slope(1, 1) = s + y * y * ds + 6.0 * p1 * y + 2.0 * p2 * x;
  return d;
}

}  // namespace

MeasuredLens MeasuredLens::from_focal(int width_px, int height_px, double focal_px) {
  MeasuredLens lens;
  lens.width_px = width_px;
  lens.height_px = height_px;
  lens.values = {focal_px, 0.5 * width_px, 0.5 * height_px, 0.0, 0.0, 0.0, 0.0, 0.0};
  const double centre = width_px / 50.0;
  const double sigmas[kParameters] = {focal_px / 20.0, centre, centre, 0.1, 0.1, 1e-6, 2e-3, 2e-3};
  for (int i = 0; i < kParameters; ++i) lens.covariance(i, i) = sigmas[i] * sigmas[i];
  return lens;
}

std::optional<Eigen::Vector2d> MeasuredLens::pixel_of(const Eigen::Vector3d& point) const {
  if (!(point.z() > kInFront * point.norm())) return std::nullopt;
  if (!rises_to(values, point.head<2>().norm() / point.z())) return std::nullopt;
  Eigen::Vector2d pixel;
  project_through_lens(values.data(), point.data(), pixel.data());
  if (!pixel.allFinite()) return std::nullopt;
  return pixel;
}

std::optional<Eigen::Vector3d> MeasuredLens::direction_at(const Eigen::Vector2d& pixel) const {
  const double f = values[kFocal];
  if (!(f > 0.0) || !pixel.allFinite()) return std::nullopt;
  const Eigen::Vector2d target = (pixel - Eigen::Vector2d(values[kCentreU], values[kCentreV])) / f;
  Eigen::Vector2d at = target;
  double error = (distorted(values, at.x(), at.y()).place - target).norm();
  if (!rises_to(values, at.norm())) {  // From within the turning point, so that the right branch is found.
    at.setZero();
    error = target.norm();
  }
  for (int step = 0; step < kMostSteps && error > kConverged; ++step) {
    const Distorted d = distorted(values, at.x(), at.y());
    if (!(d.slope.determinant() > 0.0)) return std::nullopt;
    const Eigen::Vector2d move = d.slope.inverse() * (target - d.place);
    double part = 1.0;
    Eigen::Vector2d next = at + move;
    double next_error = (distorted(values, next.x(), next.y()).place - target).norm();
    while (!(next_error < error) && part > 1e-6) {
      part *= 0.5;
      next = at + part * move;
      next_error = (distorted(values, next.x(), next.y()).place - target).norm();
    }
    if (!(next_error < error)) break;
    at = next;
    error = next_error;
  }
  constexpr double kGoodEnough = 1e-12;
  if (!(error < kGoodEnough) || !rises_to(values, at.norm())) return std::nullopt;
  return Eigen::Vector3d(at.x(), at.y(), 1.0);
}

}  // namespace cyclorama
