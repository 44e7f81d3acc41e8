// SPDX-License-Identifier: Apache-2.0
/// The turntable's bundle adjustment as a least-squares problem. What all directions share is few numbers; each track
/// adds a direction of its own, which is eliminated (Schur), so the equations that are solved stay small.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "appliance/solve/damped_steps.h"
#include "appliance/solve/turntable_problem.h"

namespace cyclorama::solve {

/// Borrows all for its life, and moves `state`. Thread-bound.
class TurntableAdjustment final : public DampedProblem {
 public:
  /// `tracks`, with a direction each in `state`. Camera's offset and wall's inverse_depth move only if `with_offset`.
  TurntableAdjustment(const TurntableTask& task, const TurntableHints& hints, bool with_offset,
                      const std::vector<const Track*>& tracks, TurntableState* state);

  void weigh_by(RobustLoss loss) override { loss_ = loss; }
  std::optional<double> linearise() override;
  std::optional<Attempt> attempt(double damping) override;
  void accept() override { std::swap(*state_, candidate_); }

  /// Of what is shared, the tracks eliminated: the lower triangle of the normal matrix where it stands; of the
  /// measurements without priors and without what is known of before if `measured_alone`.
  [[nodiscard]] Eigen::MatrixXd reduced_normal(bool measured_alone) const;
  /// Of what is shared, in the order of those matrices.
  [[nodiscard]] std::vector<std::string> names() const;
  [[nodiscard]] std::vector<double> prior_sigmas() const;

 private:
  /// One of the numbers that are shared.
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
  /// What one track adds to the equations.
  struct TrackEquations {
    Eigen::Matrix<double, 3, 2> tangent;  ///< In which its direction moves.
    Eigen::Matrix2d own = Eigen::Matrix2d::Zero();
    Eigen::Vector2d own_gradient = Eigen::Vector2d::Zero();
    Eigen::Matrix<double, 2, 3> by_turn = Eigen::Matrix<double, 2, 3>::Zero();
  };
  using ObservationCross = Eigen::Matrix<double, 2, kObservationParameters>;
  struct Equations {
    std::vector<TrackEquations> tracks;
    std::vector<ObservationCross> crosses;  ///< Own direction by what is shared, of each sight.
    Eigen::VectorXd gradient;               ///< Of what is shared.
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
  /// Where a sight's numbers lie among those that are shared; -1: it stays as it is.
  [[nodiscard]] Eigen::Index column_of(int parameter_index, std::size_t direction) const;
  /// Half the sum of robust squares; fills the equations unless they are null.
  std::optional<double> add_measured(TurntableState* state, bool with_known, Equations* ret) const;
  double add_priors(TurntableState* state, Eigen::VectorXd* ret_gradient, Eigen::MatrixXd* ret_normal) const;
  /// A track's cross matrix: only these columns of it are not 0.
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
  std::vector<Eigen::Index> columns_;        ///< Of a sight's numbers but the angle.
  std::vector<Eigen::Index> angle_columns_;  ///< By direction.
  Eigen::Index turn_column_ = -1;
  Eigen::VectorXd prior_means_;
  Eigen::MatrixXd prior_normal_;
  RobustLoss loss_ = RobustLoss::kHuber;
  Equations equations_;
};

}  // namespace cyclorama::solve
