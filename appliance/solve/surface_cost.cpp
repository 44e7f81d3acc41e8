// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/surface_cost.h"

#include <ceres/jet.h>
#include <ceres/rotation.h>

#include <algorithm>

namespace cyclorama::solve {
namespace {

constexpr double kScaleSigma = 1e-5;  // Relative; tight, since the scale is a gauge freedom and not measured.
constexpr double kMinDepth = 1e-4;    // Minimum depth relative to the point's distance from the eye.

}  // namespace

LitProjector::LitProjector(const Eigen::Matrix3d& R_eye_projector, const double* numbers)
    : place_(numbers[3], numbers[4], numbers[5]) {
  using Jet = ceres::Jet<double, 3>;
  const Jet back[3] = {-Jet(numbers[0], 0), -Jet(numbers[1], 1), -Jet(numbers[2], 2)};
  Jet turn[9];  // Column-major, as in Eigen.
  ceres::AngleAxisToRotationMatrix(back, turn);
  Eigen::Matrix3d R = Eigen::Matrix3d::Zero();
  std::array<Eigen::Matrix3d, 3> slopes;
  slopes.fill(Eigen::Matrix3d::Zero());
  for (int i = 0; i < 9; ++i) {
    R.data()[i] = turn[i].a;
    for (int k = 0; k < 3; ++k) slopes[static_cast<std::size_t>(k)].data()[i] = turn[i].v[k];
  }
  R_projector_eye_ = R * R_eye_projector.transpose();
  for (std::size_t k = 0; k < 3; ++k) R_slopes_[k] = slopes[k] * R_eye_projector.transpose();
  std::copy_n(numbers + 6, lens_.size(), lens_.begin());
}

bool LitProjector::residuals(const MapSample& sample, double inverse_depth, Eigen::Vector2d* ret_residuals,
                             Slopes* ret_slopes) const {
  const Eigen::Vector3d moved = sample.direction - inverse_depth * place_;
  const Eigen::Vector3d point = R_projector_eye_ * moved;
  if (!(point.z() > kMinDepth)) return false;
  if (ret_slopes == nullptr) {
    Eigen::Vector2d pixel;
    calibration::project_through_lens(lens_.data(), point.data(), pixel.data());
    *ret_residuals = (pixel - sample.projector_px) / sample.sigma_px;
    return true;
  }
  const calibration::LensSlopes lens = calibration::slopes_through_lens(lens_.data(), point);
  *ret_residuals = (lens.pixel - sample.projector_px) / sample.sigma_px;
  const Eigen::Matrix<double, 2, 3> by_point = lens.by_point / sample.sigma_px;
  const Eigen::Matrix<double, 2, 3> by_moved = by_point * R_projector_eye_;
  for (int k = 0; k < 3; ++k) {
    ret_slopes->by_numbers.col(k) = by_point * (R_slopes_[static_cast<std::size_t>(k)] * moved);
  }
  ret_slopes->by_numbers.middleCols<3>(3) = -inverse_depth * by_moved;
  ret_slopes->by_numbers.rightCols<calibration::MeasuredLens::kParameters>() = lens.by_lens / sample.sigma_px;
  ret_slopes->by_inverse_depth = -by_moved * place_;
  return true;
}

SplinePrior::SplinePrior(const calibration::Surface& shape, double bend_sigma)
    : weight_(shape.distance_m / bend_sigma) {
  const int first = shape.model == calibration::SurfaceModel::kProfile ? 2 : 0;
  const int columns = shape.across.coefficients();
  const int rows = shape.model == calibration::SurfaceModel::kProfile ? 1 : shape.up.coefficients();
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const int at = first + y * columns + x;
      if (x + 2 < columns) bends_.push_back({at, at + 1, at + 2});
      if (y + 2 < rows) bends_.push_back({at, at + columns, at + 2 * columns});
    }
  }
}

std::optional<double> SplinePrior::add(const calibration::Surface& shape, const double* parameters,
                                       Eigen::VectorXd* ret_gradient, Eigen::MatrixXd* ret_normal) const {
  constexpr double kFactors[] = {1.0, -2.0, 1.0};
  const double square = weight_ * weight_;
  double cost = 0.0;
  for (const std::array<int, 3>& bend : bends_) {
    const double sum = parameters[bend[0]] - 2.0 * parameters[bend[1]] + parameters[bend[2]];
    cost += 0.5 * square * sum * sum;
    if (ret_gradient == nullptr) continue;
    for (std::size_t i = 0; i < 3; ++i) {  // Ascending indices.
      (*ret_gradient)[bend[i]] += square * kFactors[i] * sum;
      for (std::size_t j = 0; j <= i; ++j) (*ret_normal)(bend[i], bend[j]) += square * kFactors[i] * kFactors[j];
    }
  }
  calibration::InverseDepthSlopes slopes;
  const auto inverse_depth =
      shape.inverse_depth_at(parameters, -shape.R_eye_wall.col(2), ret_gradient == nullptr ? nullptr : &slopes);
  if (!inverse_depth) return std::nullopt;
  const double scale = shape.distance_m / kScaleSigma;
  const double error = scale * (*inverse_depth - 1.0 / shape.distance_m);
  for (std::size_t i = 0; i < static_cast<std::size_t>(slopes.count); ++i) {
    (*ret_gradient)[slopes.parameters[i]] += scale * slopes.slopes[i] * error;
    for (std::size_t j = 0; j < static_cast<std::size_t>(slopes.count); ++j) {
      if (slopes.parameters[j] > slopes.parameters[i]) continue;
      (*ret_normal)(slopes.parameters[i], slopes.parameters[j]) += scale * scale * slopes.slopes[i] * slopes.slopes[j];
    }
  }
  return cost + 0.5 * error * error;
}

}  // namespace cyclorama::solve
