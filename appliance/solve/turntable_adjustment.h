// SPDX-License-Identifier: Apache-2.0
/// The bundle adjustment of the turntable as a least-squares problem. A few parameters are shared; each track adds the
/// direction of its wall point, which is eliminated (Schur complement), so that the system to be solved stays small.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "appliance/solve/damped_steps.h"
#include "appliance/solve/turntable_problem.h"

namespace cyclorama::solve {

/// Borrows its arguments, which must outlive it, and modifies `state`. Thread-bound.
class TurntableAdjustment final : public DampedProblem {
 public:
  /// `state` has one direction per element of `tracks`. The camera's offset and the wall's inverse depth are free only
  /// if `with_offset`.
  TurntableAdjustment(const TurntableTask& task, const TurntableHints& hints, bool with_offset,
                      const std::vector<const Track*>& tracks, TurntableState* state);

  void weigh_by(RobustLoss loss) override { loss_ = loss; }
  std::optional<double> linearise() override;
  std::optional<Attempt> attempt(double damping) override;
  void accept() override { std::swap(*state_, candidate_); }

  /// Returns the lower triangle of the normal matrix of the shared parameters at the current state, with the tracks
  /// eliminated. If `measured_alone`, priors and the known directions of an earlier calibration are omitted.
  [[nodiscard]] Eigen::MatrixXd reduced_normal(bool measured_alone) const;
  /// Returns the names of the shared parameters, in the order of reduced_normal().
  [[nodiscard]] std::vector<std::string> names() const;
  [[nodiscard]] std::vector<double> prior_sigmas() const;

 private:
  /// One shared parameter.
  struct Shared {
    enum Kind { kLens, kMount, kOffset, kInverseDepth, kTurn, kAngle } kind;
    std::size_t index;
  };
  struct TrackObservation {
    TurntableObservation observation;
    std::size_t direction;
  };
  struct TrackData {
    std::size_t first_observation = 0;
    std::size_t observations = 0;
    double wall_inverse_depth = 0.0;
    std::optional<KnownDirection> known{};
  };
  /// The contribution of one track to the equations.
  struct TrackEquations {
    Eigen::Matrix<double, 3, 2> tangent;  ///< Basis of the tangent plane in which the track's direction moves.
    Eigen::Matrix2d own = Eigen::Matrix2d::Zero();
    Eigen::Vector2d own_gradient = Eigen::Vector2d::Zero();
    Eigen::Matrix<double, 2, 3> by_turn = Eigen::Matrix<double, 2, 3>::Zero();
  };
  using ObservationCross = Eigen::Matrix<double, 2, kObservationParameters>;
  struct Equations {
    std::vector<TrackEquations> tracks;
    std::vector<ObservationCross> crosses;  ///< Per observation: track's direction by shared parameters.
    Eigen::VectorXd gradient;               ///< Derivative by the shared parameters.
    Eigen::MatrixXd normal;                 ///< Lower triangle.
  };
  struct Elimination {
    Eigen::MatrixXd normal;
    Eigen::VectorXd gradient;
  };

  void choose_shared(bool with_offset, bool with_turn);
  [[nodiscard]] double* number(TurntableState* state, const Shared& shared) const;
  [[nodiscard]] double prior_sigma(const Shared& shared) const;
  [[nodiscard]] Eigen::VectorXd shared_numbers(TurntableState* state) const;
  /// Returns the column of an observation's parameter among the shared parameters; -1 if the parameter is not free.
  [[nodiscard]] Eigen::Index column_of(int parameter_index, std::size_t direction) const;
  /// Returns half the sum of robust squares; fills the equations unless they are null.
  std::optional<double> add_measured(TurntableState* state, bool with_known, Equations* ret) const;
  double add_priors(TurntableState* state, Eigen::VectorXd* ret_gradient, Eigen::MatrixXd* ret_normal) const;
  /// Computes a track's cross matrix, restricted to its nonzero columns.
  void cross_of(const Equations& equations, std::size_t track, std::vector<Eigen::Index>* ret_columns,
                Eigen::Matrix2Xd* ret_cross) const;
  [[nodiscard]] Elimination eliminated(const Equations& equations, double damping) const;

  const Measurements& measurements_;
  const TurntableSolverOptions& options_;
  std::size_t reference_;
  TurntableState* state_;
  TurntableState candidate_;
  std::vector<TrackData> tracks_;
  std::vector<TrackObservation> observations_;
  std::vector<Shared> shared_;
  std::vector<Eigen::Index> columns_;        ///< Columns of an observation's parameters except the angle.
  std::vector<Eigen::Index> angle_columns_;  ///< Angle columns, by direction.
  Eigen::Index turn_column_ = -1;
  Eigen::VectorXd prior_means_;
  Eigen::MatrixXd prior_normal_;
  RobustLoss loss_ = RobustLoss::kHuber;
  Equations equations_;
};

}  // namespace cyclorama::solve
