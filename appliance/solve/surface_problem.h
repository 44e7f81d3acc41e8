// SPDX-License-Identifier: Apache-2.0
/// The least-squares problem of surface_fit.cpp: a wall and all projectors at once. A sample depends on one projector
/// and a few nearby wall parameters, so its terms are added directly to the normal equations: a Jacobian of all samples
/// would be mostly zero.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "appliance/solve/damped_steps.h"
#include "appliance/solve/measurements.h"
#include "appliance/solve/surface_cost.h"
#include "appliance/solve/surface_fit.h"

namespace cyclorama::solve {

/// Borrows its arguments, which must outlive it. Thread-bound.
class SurfaceProblem final : public DampedProblem {
 public:
  SurfaceProblem(const std::vector<MeasuredProjector>& projectors, std::span<const MapSample> samples,
                 const calibration::SurfaceFit& start, calibration::LensModel lens);

  void weigh_by(RobustLoss loss) override { loss_ = loss; }
  std::optional<double> linearise() override;
  std::optional<Attempt> attempt(double damping) override;
  void accept() override { numbers_ = candidate_; }

  /// Returns the lower triangle of J'J at the current state, for all free parameters: those of the surface, then each
  /// projector's rotation, position and free lens parameters. Priors are omitted if `measured_alone`.
  [[nodiscard]] Eigen::MatrixXd normal(bool measured_alone) const;
  /// Returns the priors' sigmas, in the order of normal().
  [[nodiscard]] std::vector<double> scales() const;
  /// Returns the indices of the free lens parameters.
  [[nodiscard]] const std::vector<int>& free_of_lens() const { return free_of_lens_; }
  [[nodiscard]] const calibration::Surface& surface() const { return surface_; }
  /// Returns the current estimate without covariances.
  [[nodiscard]] calibration::SurfaceFit found(double cost) const;

 private:
  [[nodiscard]] Eigen::Index first_of(std::size_t projector) const;
  [[nodiscard]] std::array<double, LitProjector::kNumbers> numbers_of(const Eigen::VectorXd& at,
                                                                      std::size_t projector) const;
  /// Returns half the sum of robust squares; adds to gradient and normal matrix unless they are null.
  std::optional<double> add_samples(const Eigen::VectorXd& at, Eigen::VectorXd* ret_gradient,
                                    Eigen::MatrixXd* ret_normal) const;
  std::optional<double> add_priors(const Eigen::VectorXd& at, Eigen::VectorXd* ret_gradient,
                                   Eigen::MatrixXd* ret_normal) const;
  std::optional<double> add_all(const Eigen::VectorXd& at, Eigen::VectorXd* ret_gradient,
                                Eigen::MatrixXd* ret_normal) const;

  const std::vector<MeasuredProjector>& projectors_;
  std::span<const MapSample> samples_;
  const calibration::SurfaceFit& start_;
  calibration::Surface surface_;  ///< Its parameters are those of the start.
  std::vector<int> free_of_lens_;
  std::vector<Eigen::Matrix3d> axes_;  ///< R_eye_projector of each projector at the start.
  std::optional<SplinePrior> spline_prior_;
  Eigen::VectorXd prior_means_;   ///< Prior means of the projectors' parameters, from first_of(0) on.
  Eigen::VectorXd prior_sigmas_;  ///< Sigmas of `prior_means_`.
  RobustLoss loss_ = RobustLoss::kHuber;
  Eigen::VectorXd numbers_;
  Eigen::VectorXd candidate_;
  Eigen::VectorXd gradient_;
  Eigen::MatrixXd normal_;
};

}  // namespace cyclorama::solve
