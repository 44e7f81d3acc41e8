// SPDX-License-Identifier: Apache-2.0
/// The residuals of surface_fit.cpp and their derivatives: the distance, in projector pixels, between the pixel that
/// was decoded and the one that a fitted projector would light.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "appliance/calibration/measured_lens.h"
#include "appliance/calibration/surface.h"
#include "appliance/solve/map_fit.h"

namespace cyclorama::solve {

/// A projector where a solver has it, for the residuals of many samples. Its numbers: the turn (3, an angle axis
/// applied in its own frame after `R_eye_projector`), its place (3) and its lens (8). A value; reentrant.
class LitProjector {
 public:
  static constexpr int kNumbers = 6 + calibration::MeasuredLens::kParameters;
  struct Slopes {
    Eigen::Vector2d by_inverse_depth;
    Eigen::Matrix<double, 2, kNumbers> by_numbers;
  };

  LitProjector(const Eigen::Matrix3d& R_eye_projector, const double* numbers);
  /// Two, in sigmas, of a sample where the wall is so near; `ret_slopes` may be null. False behind the projector.
  bool residuals(const MapSample& sample, double inverse_depth, Eigen::Vector2d* ret_residuals,
                 Slopes* ret_slopes) const;

 private:
  Eigen::Matrix3d R_projector_eye_;          ///< With the turn,
  std::array<Eigen::Matrix3d, 3> R_slopes_;  ///< and how it changes with each of its numbers.
  Eigen::Vector3d place_;
  std::array<double, calibration::MeasuredLens::kParameters> lens_{};
};

/// Smoothness of a profile or a mesh, and the scale of all. Sigmas are relative to the wall's inverse_depth straight ahead.
class SplinePrior {
 public:
  SplinePrior(const calibration::Surface& shape, double bend_sigma);
  /// Half the sum of squares; nothing where the wall has no inverse_depth straight ahead. `ret_gradient` and the lower
  /// triangle of `ret_normal` (both or none may be null) get its share added, at the surface's parameters.
  [[nodiscard]] std::optional<double> add(const calibration::Surface& shape, const double* parameters,
                                          Eigen::VectorXd* ret_gradient, Eigen::MatrixXd* ret_normal) const;

 private:
  double weight_;
  std::vector<std::array<int, 3>> bends_;  ///< Parameters beside one another.
};

}  // namespace cyclorama::solve
