// SPDX-License-Identifier: Apache-2.0
/// The residuals of surface_fit.cpp and their derivatives: the distance, in projector pixels, between the pixel
/// decoded for a wall point and the pixel with which the fitted projector would light that point.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "appliance/calibration/measured_lens.h"
#include "appliance/calibration/surface.h"
#include "appliance/solve/map_fit.h"

namespace cyclorama::solve {

/// A projector at the solver's current parameters, for the residuals of many samples. The parameters are the rotation
/// (3, an angle axis in the projector's frame, applied after `R_eye_projector`), the position (3) and the lens (8). A
/// value; reentrant.
class LitProjector {
 public:
  static constexpr int kNumbers = 6 + calibration::MeasuredLens::kParameters;
  struct Slopes {
    Eigen::Vector2d by_inverse_depth;
    Eigen::Matrix<double, 2, kNumbers> by_numbers;
  };

  LitProjector(const Eigen::Matrix3d& R_eye_projector, const double* numbers);
  /// Computes the two residuals of a sample, in sigmas, at the given inverse depth of the wall; `ret_slopes` may be
  /// null. Returns false if the point is behind the projector.
  bool residuals(const MapSample& sample, double inverse_depth, Eigen::Vector2d* ret_residuals,
                 Slopes* ret_slopes) const;

 private:
  Eigen::Matrix3d R_projector_eye_;          ///< Includes the rotation parameters.
  std::array<Eigen::Matrix3d, 3> R_slopes_;  ///< Derivatives of R_projector_eye_ by the rotation parameters.
  Eigen::Vector3d place_;
  std::array<double, calibration::MeasuredLens::kParameters> lens_{};
};

/// Smoothness prior of a profile or a mesh, and prior of the overall scale. Sigmas are relative to the wall's inverse
/// depth straight ahead.
class SplinePrior {
 public:
  SplinePrior(const calibration::Surface& shape, double bend_sigma);
  /// Returns half the sum of squares; nothing if the wall has no inverse depth straight ahead. Adds the prior's terms
  /// to `ret_gradient` and to the lower triangle of `ret_normal` at the surface's parameters; both or neither may be
  /// null.
  [[nodiscard]] std::optional<double> add(const calibration::Surface& shape, const double* parameters,
                                          Eigen::VectorXd* ret_gradient, Eigen::MatrixXd* ret_normal) const;

 private:
  double weight_;
  std::vector<std::array<int, 3>> bends_;  ///< Triples of adjacent parameters.
};

}  // namespace cyclorama::solve
