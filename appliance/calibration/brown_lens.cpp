// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibration/brown_lens.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace cyclorama::calibration {
namespace {

double value_of(const std::vector<double>& polynomial, double at) {
  double sum = 0.0;
  for (auto c = polynomial.rbegin(); c != polynomial.rend(); ++c) sum = sum * at + *c;
  return sum;
}

/// Returns all points in (0, limit) where the polynomial (lowest power first) changes sign, in ascending order. Between
/// two extrema, which are roots of its derivative, there is at most one.
std::vector<double> sign_changes(const std::vector<double>& polynomial, double limit) {
  if (polynomial.size() < 2) return {};
  std::vector<double> derivative;
  for (std::size_t i = 1; i < polynomial.size(); ++i) derivative.push_back(static_cast<double>(i) * polynomial[i]);
  std::vector<double> bounds = sign_changes(derivative, limit);
  bounds.push_back(limit);
  std::vector<double> found;
  double low = 0.0;
  for (const double bound : bounds) {
    double a = low;
    double b = bound;
    low = bound;
    const bool is_positive = value_of(polynomial, a) > 0.0;
    if ((value_of(polynomial, b) > 0.0) == is_positive) continue;
    for (int i = 0; i < 2000; ++i) {
      const double middle = 0.5 * (a + b);
      if (!(middle > a && middle < b)) break;
      ((value_of(polynomial, middle) > 0.0) == is_positive ? a : b) = middle;
    }
    found.push_back(a);
  }
  return found;
}

/// Returns the slope at which the magnification reaches its minimum. At slope r the Jacobian's eigenvalues are the
/// magnifications across the ray, R, and along it, d(rR)/dr. Decentring reduces either by at most 6 |p| r: it adds 2
/// (p·x I + p xᵀ + x pᵀ), with p = (p2, p1).
double slope_of_min_magnification(const BrownParameters& lens) {
  const double decentring = -6.0 * std::hypot(lens.p1, lens.p2);
  const double one = 1.0 - BrownLens::kMinMagnification;
  double min = BrownLens::kMaxSlope;
  for (const auto& [a, b, c] :
       {std::array{lens.k1, lens.k2, lens.k3}, std::array{3 * lens.k1, 5 * lens.k2, 7 * lens.k3}}) {
    const auto roots = sign_changes({one, decentring, a, 0.0, b, 0.0, c}, min);
    if (!roots.empty()) min = std::min(min, roots.front());
  }
  return min;
}

}  // namespace

Result<BrownLens> BrownLens::from(const BrownParameters& parameters) {
  for (const double value : to_block(parameters)) {
    // Above this, powers of the largest slope would overflow.
    if (!(std::abs(value) < 1e100)) {
      return Error(ErrorCode::kInvalidArgument, "a lens whose numbers are not finite: calibrate the camera again");
    }
  }
  if (parameters.width_px <= 0 || parameters.height_px <= 0 || !(parameters.focal_u_px > 0.0) ||
      !(parameters.focal_v_px > 0.0)) {
    return Error(ErrorCode::kInvalidArgument, "a lens needs a picture's size and focal lengths greater than 0");
  }
  return BrownLens(parameters);
}

BrownLens::BrownLens(const BrownParameters& parameters)
    : parameters_(parameters), trusted_slope_(slope_of_min_magnification(parameters)) {}

Eigen::Vector2d BrownLens::distorted(const Eigen::Vector2d& slope) const {
  const BrownBlock unit = {1.0,           1.0, 0.0, 0.0, parameters_.k1, parameters_.k2, parameters_.p1, parameters_.p2,
                           parameters_.k3};
  Eigen::Vector2d result;
  brown_pixel(unit.data(), slope.x(), slope.y(), &result.x(), &result.y());
  return result;
}

Eigen::Matrix2d BrownLens::distortion_jacobian(const Eigen::Vector2d& slope) const {
  const BrownParameters& lens = parameters_;
  const double rr = slope.squaredNorm();
  const double radial = 1.0 + rr * (lens.k1 + rr * (lens.k2 + rr * lens.k3));
  const double per_rr = lens.k1 + rr * (2.0 * lens.k2 + rr * 3.0 * lens.k3);
  const Eigen::Vector2d p(lens.p2, lens.p1);
  return (radial + 2.0 * p.dot(slope)) * Eigen::Matrix2d::Identity() + 2.0 * per_rr * slope * slope.transpose() +
         2.0 * (p * slope.transpose() + slope * p.transpose());
}

double BrownLens::potential(const Eigen::Vector2d& slope) const {
  const BrownParameters& lens = parameters_;
  const double rr = slope.squaredNorm();
  const double radial = rr * (0.5 + rr * (lens.k1 / 4.0 + rr * (lens.k2 / 6.0 + rr * lens.k3 / 8.0)));
  return radial + rr * (lens.p1 * slope.y() + lens.p2 * slope.x());
}

Eigen::Matrix2d BrownLens::jacobian(const Eigen::Vector2d& slope) const {
  return Eigen::Vector2d(parameters_.focal_u_px, parameters_.focal_v_px).asDiagonal() * distortion_jacobian(slope);
}

std::optional<Eigen::Vector2d> BrownLens::pixel_of_slope(const Eigen::Vector2d& slope) const {
  if (!(slope.norm() <= trusted_slope_)) return std::nullopt;
  const Eigen::Vector2d bent = distorted(slope);
  return Eigen::Vector2d(parameters_.centre_u_px + parameters_.focal_u_px * bent.x(),
                         parameters_.centre_v_px + parameters_.focal_v_px * bent.y());
}

std::optional<Eigen::Vector2d> BrownLens::pixel_of(const Eigen::Vector3d& point) const {
  if (!(point.z() > 0.0)) return std::nullopt;
  return pixel_of_slope(point.head<2>() / point.z());
}

SlopeAnswer BrownLens::slope_at(const Eigen::Vector2d& pixel) const {
  if (!pixel.allFinite()) return {Eigen::Vector2d::Zero(), LensRefusal::kNotFinite};
  const SlopeAnswer refused = {Eigen::Vector2d::Zero(), LensRefusal::kBeyondFold};
  const Eigen::Vector2d focal(parameters_.focal_u_px, parameters_.focal_v_px);
  const Eigen::Vector2d wanted((pixel.x() - parameters_.centre_u_px) / focal.x(),
                               (pixel.y() - parameters_.centre_v_px) / focal.y());
  Eigen::Vector2d slope = wanted;
  if (slope.norm() > 0.9 * trusted_slope_) slope *= 0.9 * trusted_slope_ / slope.norm();
  Eigen::Vector2d error = distorted(slope) - wanted;
  for (int i = 0; i < 200; ++i) {
    const double error_px = error.cwiseProduct(focal).norm();
    if (error_px <= 1e-3 * kRoundTripPx) break;
    const Eigen::Vector2d step = -distortion_jacobian(slope).inverse() * error;
    const double height = potential(slope) - wanted.dot(slope);
    bool has_gone_down = false;
    for (double share = 1.0; share > 1e-9; share *= 0.5) {
      const Eigen::Vector2d next = slope + share * step;
      if (!(next.norm() <= trusted_slope_)) continue;
      const Eigen::Vector2d next_error = distorted(next) - wanted;
      // Near the minimum, rounding hides the potential's decrease, so the error decides.
      if (next_error.norm() <= 0.5 * error.norm() ||
          potential(next) - wanted.dot(next) <= height + 1e-4 * share * step.dot(error)) {
        slope = next;
        error = next_error;
        has_gone_down = true;
        break;
      }
    }
    if (!has_gone_down) break;
  }
  if (!(error.cwiseProduct(focal).norm() <= kRoundTripPx)) return refused;
  return {slope, LensRefusal::kNone};
}

Status BrownLens::covers_picture() const {
  // The image of the trusted disc has no holes, so a picture lies inside it if its border does.
  const int width = parameters_.width_px;
  const int height = parameters_.height_px;
  const auto check = [this](double u, double v) -> Status {
    if (slope_at({u, v})) return Done{};
    return Error(ErrorCode::kInvalidArgument,
                 "the lens's distortion folds over at slope " + std::to_string(trusted_slope_) +
                     ", before the picture's (" + std::to_string(u) + ", " + std::to_string(v) +
                     "): calibrate it with a board that reaches the corners, or with fewer coefficients");
  };
  for (int x = 0; x <= width; ++x) {
    TRY(check(x, 0.0));
    TRY(check(x, height));
  }
  for (int y = 0; y <= height; ++y) {
    TRY(check(0.0, y));
    TRY(check(width, y));
  }
  return Done{};
}

}  // namespace cyclorama::calibration
