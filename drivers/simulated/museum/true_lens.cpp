// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/true_lens.h"

#include <Eigen/LU>
#include <cmath>
#include <utility>

namespace cyclorama::simulated {
namespace {

constexpr double kMaxTangent = 20.0;  // 87 degrees from the axis, beyond any pinhole picture.

/// Derivative of the distorted radius with respect to the radius; beyond its first root the distorted radius decreases.
double radial_slope(const std::array<double, 3>& k, double r) {
  const double s = r * r;
  return 1.0 + s * (3.0 * k[0] + s * (5.0 * k[1] + s * 7.0 * k[2]));
}

double turning_radius(const std::array<double, 3>& k) {
  constexpr int kSteps = 4000;
  double inside = 0.0;
  for (int i = 1; i <= kSteps; ++i) {
    // Steps grow with the radius, since a distortion that turns back does so near the axis.
    const double part = static_cast<double>(i) / kSteps;
    const double r = kMaxTangent * part * part;
    if (radial_slope(k, r) > 0.0) {
      inside = r;
      continue;
    }
    double outside = r;
    for (int j = 0; j < 60; ++j) {
      const double middle = 0.5 * (inside + outside);
      (radial_slope(k, middle) > 0.0 ? inside : outside) = middle;
    }
    return inside;
  }
  return kMaxTangent;
}

}  // namespace

TrueLens::TrueLens(const Pinhole& pinhole, const std::array<double, 3>& radial, const std::array<double, 2>& tangential,
                   std::vector<LensWave> waves)
    : pinhole_(pinhole),
      radial_(radial),
      tangential_(tangential),
      waves_(std::move(waves)),
      max_tangent_(turning_radius(radial)) {}

Eigen::Vector2d TrueLens::distorted(const Eigen::Vector2d& ideal) const {
  const Eigen::Vector2d smooth = brown(ideal);
  Eigen::Vector2d seen = smooth;
  for (const LensWave& wave : waves_) {
    const double angle = pinhole_.focal_px * wave.rad_per_px.dot(smooth) + wave.phase_rad;
    seen += std::sin(angle) / pinhole_.focal_px * wave.shift_px;
  }
  return seen;
}

Eigen::Matrix2d TrueLens::derivative(const Eigen::Vector2d& ideal) const {
  const Eigen::Matrix2d by_ideal = brown_derivative(ideal);
  if (waves_.empty()) return by_ideal;
  const Eigen::Vector2d smooth = brown(ideal);
  Eigen::Matrix2d by_smooth = Eigen::Matrix2d::Identity();
  for (const LensWave& wave : waves_) {
    const double angle = pinhole_.focal_px * wave.rad_per_px.dot(smooth) + wave.phase_rad;
    by_smooth += std::cos(angle) * wave.shift_px * wave.rad_per_px.transpose();
  }
  return by_smooth * by_ideal;
}

Eigen::Vector2d TrueLens::brown(const Eigen::Vector2d& ideal) const {
  const double x = ideal.x();
  const double y = ideal.y();
  const double s = x * x + y * y;
  const double scale = 1.0 + s * (radial_[0] + s * (radial_[1] + s * radial_[2]));
  const auto [p1, p2] = tangential_;
  return {x * scale + 2.0 * p1 * x * y + p2 * (s + 2.0 * x * x), y * scale + p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y};
}

Eigen::Matrix2d TrueLens::brown_derivative(const Eigen::Vector2d& ideal) const {
  const double x = ideal.x();
  const double y = ideal.y();
  const double s = x * x + y * y;
  const double scale = 1.0 + s * (radial_[0] + s * (radial_[1] + s * radial_[2]));
  const double by_s = radial_[0] + s * (2.0 * radial_[1] + s * 3.0 * radial_[2]);
  const auto [p1, p2] = tangential_;
  Eigen::Matrix2d m;
  m(0, 0) = scale + 2.0 * x * x * by_s + 2.0 * p1 * y + 6.0 * p2 * x;
  m(0, 1) = 2.0 * x * y * by_s + 2.0 * p1 * x + 2.0 * p2 * y;
  m(1, 0) = m(0, 1);
  m(1, 1) = scale + 2.0 * y * y * by_s + 6.0 * p1 * y + 2.0 * p2 * x;
  return m;
}

std::optional<Eigen::Vector2d> TrueLens::undistorted(const Eigen::Vector2d& seen) const {
  constexpr int kMaxSteps = 50;
  constexpr double kClose = 1e-13;
  Eigen::Vector2d ideal = seen;
  if (ideal.norm() > 0.9 * max_tangent_) ideal *= 0.9 * max_tangent_ / ideal.norm();
  for (int i = 0; i < kMaxSteps; ++i) {
    const Eigen::Vector2d off = distorted(ideal) - seen;
    if (!off.allFinite()) return std::nullopt;
    if (off.norm() <= kClose * (1.0 + seen.norm())) break;
    const Eigen::Matrix2d slope = derivative(ideal);
    if (!(slope.determinant() > 1e-12)) return std::nullopt;
    ideal -= slope.inverse() * off;
    // Beyond the turning radius Newton's method would converge to an invalid ray.
    if (ideal.norm() > max_tangent_) ideal *= max_tangent_ * (1.0 - 1e-9) / ideal.norm();
  }
  if (!((distorted(ideal) - seen).norm() <= 1e-12 * (1.0 + seen.norm()))) return std::nullopt;
  return ideal;
}

std::optional<Eigen::Vector2d> TrueLens::pixel_of(const Eigen::Vector3d& point) const {
  if (!(point.z() > 1e-12)) return std::nullopt;
  const Eigen::Vector2d ideal = point.head<2>() / point.z();
  if (!(ideal.norm() < max_tangent_)) return std::nullopt;
  const Eigen::Vector2d seen = distorted(ideal);
  return Eigen::Vector2d(pinhole_.centre_u_px + pinhole_.focal_px * seen.x(),
                         pinhole_.centre_v_px + pinhole_.focal_px * seen.y());
}

std::optional<Eigen::Vector3d> TrueLens::direction_at(double u, double v) const {
  const auto ideal = undistorted(pinhole_.direction_at(u, v).head<2>());
  if (!ideal) return std::nullopt;
  return Eigen::Vector3d(ideal->x(), ideal->y(), 1.0);
}

}  // namespace cyclorama::simulated
