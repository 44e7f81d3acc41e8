// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/turntable_cost.h"

#include <ceres/jet.h>

#include <Eigen/LU>

namespace cyclorama::solve {
namespace {

constexpr double kMinDepth = 1e-6;  // Minimum depth in front of the camera.

/// Returns the gradient of the inverse depth with respect to the direction.
Eigen::Vector3d inverse_depth_slope(const calibration::InverseDepthTerms& t, const Eigen::Vector3d& d) {
  return {t[1] + t[4] * d[1] + t[6] * d[2] + 2.0 * t[7] * d[0], t[2] + t[4] * d[0] + t[5] * d[2] + 6.0 * t[8] * d[1],
          t[3] + t[5] * d[1] + t[6] * d[0] - 2.0 * t[7] * d[2]};
}

}  // namespace

Eigen::Matrix<double, calibration::kInverseDepthTerms, 1> inverse_depth_basis(const Eigen::Vector3d& d) {
  Eigen::Matrix<double, calibration::kInverseDepthTerms, 1> basis;
  basis << 1.0, d[0], d[1], d[2], d[0] * d[1], d[1] * d[2], d[2] * d[0], d[0] * d[0] - d[2] * d[2],
      3.0 * d[1] * d[1] - 1.0;
  return basis;
}

double inverse_depth_at(const calibration::InverseDepthTerms& terms, const Eigen::Vector3d& direction) {
  return inverse_depth_basis(direction).dot(
      Eigen::Map<const Eigen::Matrix<double, calibration::kInverseDepthTerms, 1>>(terms.data()));
}

TurntableObservation::TurntableObservation(const CellMean& cell)
    : camera_px(cell.camera_px), whitening(cell.camera_per_projector.inverse() / cell.sigma_px) {}

SeenFrom::SeenFrom(const std::array<double, 2>& mount, const std::array<double, 2>& offset, double angle_rad) {
  using Jet = ceres::Jet<double, kPoseNumbers>;
  const Jet mounted[] = {Jet(mount[0], 0), Jet(mount[1], 1)};
  const Jet moved[] = {Jet(offset[0], 2), Jet(offset[1], 3)};
  const Jet angle(angle_rad, 4);
  for (int column = 0; column < 4; ++column) {  // Unit vectors; the last column is the inverse depth alone.
    const Jet direction[] = {Jet(column == 0 ? 1.0 : 0.0), Jet(column == 1 ? 1.0 : 0.0), Jet(column == 2 ? 1.0 : 0.0)};
    Jet point[3];
    to_camera(mounted, moved, angle, direction, Jet(column == 3 ? 1.0 : 0.0), point);
    const auto put = [&](Linear* linear, const auto& number) {
      for (int i = 0; i < 3; ++i) {
        (column < 3 ? linear->by_direction(i, column) : linear->by_inverse_depth[i]) = number(point[i]);
      }
    };
    put(&seen_, [](const Jet& jet) { return jet.a; });
    for (int k = 0; k < kPoseNumbers; ++k) {
      put(&slopes_[static_cast<std::size_t>(k)], [k](const Jet& jet) { return jet.v[k]; });
    }
  }
}

bool SeenFrom::residuals(const TurntableObservation& observation, const double* lens,
                         const calibration::InverseDepthTerms& terms, double wall_inverse_depth,
                         const Eigen::Vector3d& direction, Eigen::Vector2d* ret_residuals, Slopes* ret_slopes) const {
  const Eigen::Matrix<double, calibration::kInverseDepthTerms, 1> basis = inverse_depth_basis(direction);
  const double inverse_depth =
      wall_inverse_depth +
      basis.dot(Eigen::Map<const Eigen::Matrix<double, calibration::kInverseDepthTerms, 1>>(terms.data()));
  const Eigen::Vector3d point = seen_.by_direction * direction + seen_.by_inverse_depth * inverse_depth;
  if (!(point.z() > kMinDepth)) return false;
  if (ret_slopes == nullptr) {
    Eigen::Vector2d pixel;
    calibration::project_through_lens(lens, point.data(), pixel.data());
    *ret_residuals = observation.whitening * (pixel - observation.camera_px);
    return true;
  }
  const calibration::LensSlopes through = calibration::slopes_through_lens(lens, point);
  *ret_residuals = observation.whitening * (through.pixel - observation.camera_px);
  const Eigen::Matrix<double, 2, 3> by_point = observation.whitening * through.by_point;
  auto& numbers = ret_slopes->by_numbers;
  numbers.middleCols<calibration::MeasuredLens::kParameters>(kLensIndex) = observation.whitening * through.by_lens;
  constexpr int kColumns[kPoseNumbers] = {kMountIndex, kMountIndex + 1, kOffsetIndex, kOffsetIndex + 1, kAngleIndex};
  for (std::size_t k = 0; k < kPoseNumbers; ++k) {
    numbers.col(kColumns[k]) =
        by_point * (slopes_[k].by_direction * direction + slopes_[k].by_inverse_depth * inverse_depth);
  }
  const Eigen::Vector2d by_inverse_depth = by_point * seen_.by_inverse_depth;
  numbers.middleCols<calibration::kInverseDepthTerms>(kInverseDepthIndex) = by_inverse_depth * basis.transpose();
  ret_slopes->by_direction =
      by_point * seen_.by_direction + by_inverse_depth * inverse_depth_slope(terms, direction).transpose();
  return true;
}

}  // namespace cyclorama::solve
