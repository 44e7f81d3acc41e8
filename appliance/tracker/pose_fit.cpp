// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/pose_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace cyclorama::tracker {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr int kMaxIterations = 40;
constexpr double kCauchyDeviations = 3.0;
/// A fit whose turn is less certain than half a circle, or whose shift is less certain than this share of the distance,
/// is no pose.
constexpr double kMaxTurnDeviation = 3.14;
constexpr double kMaxShiftShare = 0.5;

struct Fit {
  Eigen::Quaterniond rotation;
  Vector3d translation;
  double misfit = 0.0;  ///< Infinite if a point is behind the lens.
  double squares_px2 = 0.0;
  Matrix6d normal;
  Vector6d gradient;
};

/// Computes misfit, normal matrix and gradient, with respect to a turn (in the camera's axes) and a shift.
void evaluate(std::span<const SeenPoint> points, const Pinhole& lens, Fit* ret_fit) {
  ret_fit->misfit = 0.0;
  ret_fit->squares_px2 = 0.0;
  ret_fit->normal.setZero();
  ret_fit->gradient.setZero();
  constexpr double kScale = kCauchyDeviations * kCauchyDeviations;
  for (const SeenPoint& point : points) {
    const Vector3d turned = ret_fit->rotation * point.position;
    const Vector3d p = turned + ret_fit->translation;
    const auto pixel = lens.pixel_of(p);
    if (!pixel) {
      ret_fit->misfit = std::numeric_limits<double>::infinity();
      return;
    }
    const Vector2d error = *pixel - point.pixel;
    const double f = lens.focal_px / p.z();
    Eigen::Matrix<double, 2, 3> by_point;
    by_point << f, 0.0, -f * p.x() / p.z(), 0.0, f, -f * p.y() / p.z();
    Matrix3d cross;
    cross << 0.0, -turned.z(), turned.y(), turned.z(), 0.0, -turned.x(), -turned.y(), turned.x(), 0.0;
    Eigen::Matrix<double, 2, 6> jacobian;
    jacobian << -by_point * cross, by_point;
    const double squared = error.dot(point.information * error);
    const double weight = 1.0 / (1.0 + squared / kScale);
    ret_fit->misfit += kScale * std::log1p(squared / kScale);
    ret_fit->squares_px2 += error.squaredNorm();
    const Eigen::Matrix<double, 6, 2> weighted = weight * jacobian.transpose() * point.information;
    ret_fit->normal += weighted * jacobian;
    ret_fit->gradient += weighted * error;
  }
}

/// Returns the scales that make the diagonal 1, so that radians and metres have similar magnitudes.
Vector6d scale_of(const Matrix6d& normal) {
  return normal.diagonal().unaryExpr([](double d) { return d > 0.0 ? 1.0 / std::sqrt(d) : 0.0; });
}

std::optional<Matrix6d> covariance_of(const Fit& fit, std::size_t points) {
  const Vector6d scale = scale_of(fit.normal);
  const Matrix6d scaled = scale.asDiagonal() * fit.normal * scale.asDiagonal();
  const Eigen::LDLT<Matrix6d> factor(scaled);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 1e-10)) return std::nullopt;
  const Matrix6d inverse = factor.solve(Matrix6d::Identity());
  const double freedom = std::max(1.0, 2.0 * static_cast<double>(points) - 6.0);
  const Matrix6d covariance =
      std::max(1.0, fit.misfit / freedom) * Matrix6d(scale.asDiagonal() * inverse * scale.asDiagonal());
  const double max_shift = kMaxShiftShare * fit.translation.norm();
  const bool known = covariance.allFinite() &&
                     covariance.diagonal().head<3>().maxCoeff() < kMaxTurnDeviation * kMaxTurnDeviation &&
                     covariance.diagonal().tail<3>().maxCoeff() < max_shift * max_shift;
  if (!known) return std::nullopt;
  return covariance;
}

}  // namespace

std::optional<TagPose> fit_pose(std::span<const SeenPoint> points, const T_CameraTag& start, const Pinhole& lens) {
  if (points.size() < 3) return std::nullopt;
  Fit fit{start.rotation(), start.translation(), 0.0, 0.0, {}, {}};
  evaluate(points, lens, &fit);
  if (!std::isfinite(fit.misfit)) return std::nullopt;
  double damping = 1e-4;
  for (int i = 0; i < kMaxIterations; ++i) {
    const Vector6d scale = scale_of(fit.normal);
    Matrix6d damped = scale.asDiagonal() * fit.normal * scale.asDiagonal();
    damped.diagonal().array() += damping;
    const Vector6d step = -scale.cwiseProduct(Vector6d(damped.ldlt().solve(scale.cwiseProduct(fit.gradient))));
    if (!step.allFinite()) break;
    Fit next = fit;
    const double angle = step.head<3>().norm();
    if (angle > 0.0) {
      next.rotation =
          (Eigen::Quaterniond(Eigen::AngleAxisd(angle, step.head<3>() / angle)) * fit.rotation).normalized();
    }
    next.translation += step.tail<3>();
    evaluate(points, lens, &next);
    const bool better = next.misfit < fit.misfit;
    const bool settled = better && fit.misfit - next.misfit < 1e-9 * fit.misfit && angle < 1e-7;
    damping = std::max(1e-12, damping * (better ? 0.1 : 10.0));
    if (better) fit = next;
    if (settled || damping > 1e8) break;
  }
  const auto covariance = covariance_of(fit, points.size());
  if (!covariance || !fit.rotation.coeffs().allFinite() || !fit.translation.allFinite()) return std::nullopt;
  return TagPose{{fit.rotation, fit.translation},
                 std::sqrt(fit.squares_px2 / static_cast<double>(points.size())),
                 fit.misfit,
                 *covariance};
}

}  // namespace cyclorama::tracker
