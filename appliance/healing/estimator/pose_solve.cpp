// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/estimator/pose_solve.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "common/base/check.h"

namespace cyclorama::healing {
namespace {

constexpr double kLossWidth = 2.5;              // In standard deviations.
constexpr double kStages[] = {40.0, 8.0, 1.0};  // Factors on the loss's width.
// Minimum decrease of the cost for one more moving body: many times the decrease that six parameters cause by chance.
constexpr double kMinMoveGain = 40.0;

/// Residual of one PatchObservation. A camera's motion displaces its point on the wall linearly, by `by_camera` in the
/// projector's frame.
struct ObservationCost {
  calibration::BrownBlock lens;
  Eigen::Vector3d point;  ///< In the believed projector's frame.
  Eigen::Matrix<double, 3, 6> by_camera;
  Eigen::Vector2d shown;
  Eigen::Matrix2d root;

  template <typename T>
  bool operator()(const T* projector, const T* camera, T* residual) const {
    T moved[3];
    for (int i = 0; i < 3; ++i) {
      moved[i] = T(point[i]) - projector[3 + i];
      for (int k = 0; k < 6; ++k) moved[i] += by_camera(i, k) * camera[k];
    }
    const T back[3] = {-projector[0], -projector[1], -projector[2]};
    T seen[3];
    ceres::AngleAxisRotatePoint(back, moved, seen);
    if (!(seen[2] > T(1e-3))) return false;
    T u;
    T v;
    const T x = seen[0] / seen[2];
    const T y = seen[1] / seen[2];
    T block[calibration::kBrownValues];
    for (int i = 0; i < calibration::kBrownValues; ++i) block[i] = T(lens[static_cast<std::size_t>(i)]);
    calibration::brown_pixel(block, x, y, &u, &v);
    const T du = u - shown.x();
    const T dv = v - shown.y();
    residual[0] = root(0, 0) * du + root(0, 1) * dv;
    residual[1] = root(1, 0) * du + root(1, 1) * dv;
    return true;
  }
};

struct EdgeCost {
  Eigen::Matrix<double, 1, 6> by_camera;
  double off_px;
  double sigma_px;

  template <typename T>
  bool operator()(const T* camera, T* residual) const {
    T off = T(-off_px);
    for (int k = 0; k < 6; ++k) off += by_camera[k] * camera[k];
    residual[0] = off / sigma_px;
    return true;
  }
};

struct PriorCost {
  calibration::PoseMatrix root;

  template <typename T>
  bool operator()(const T* body, T* residual) const {
    for (int i = 0; i < 6; ++i) {
      residual[i] = T(0.0);
      for (int k = 0; k < 6; ++k) residual[i] += root(i, k) * body[k];
    }
    return true;
  }
};

/// Returns U with U^T U = information; also exact if it is only semidefinite.
calibration::PoseMatrix root_of(const calibration::PoseMatrix& information) {
  const Eigen::SelfAdjointEigenSolver<calibration::PoseMatrix> parts(information);
  return parts.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * parts.eigenvectors().transpose();
}

class PoseProblem {
 public:
  PoseProblem(const calibration::ShowCalibration& room, std::span<const PatchObservation> observations,
              std::span<const EdgeObservation> edges, std::span<const BodyPrior> priors)
      : projectors_(room.projectors.size()), loss_(new ceres::CauchyLoss(kLossWidth), ceres::TAKE_OWNERSHIP) {
    ceres::Problem::Options options;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    problem_ = std::make_unique<ceres::Problem>(options);
    for (const BodyPrior& prior : priors) steps_.push_back(prior.start);
    for (calibration::PoseStep& step : steps_) problem_->AddParameterBlock(step.data(), 6);
    for (const PatchObservation& s : observations) {
      const calibration::ShowProjector& projector = room.projectors[s.projector];
      const auto T = projector.T_room_projector.inverse();
      auto* cost = new ceres::AutoDiffCostFunction<ObservationCost, 2, 6, 6>(
          new ObservationCost{calibration::to_block(projector.lens), (T * Point<frame::Room>{s.wall}).xyz,
                              T.rotation().toRotationMatrix() * s.wall_by_camera, s.shown, s.root_information});
      seen_.push_back(
          problem_->AddResidualBlock(cost, &loss_, steps_[s.projector].data(), steps_[projectors_ + s.camera].data()));
    }
    for (const EdgeObservation& e : edges) {
      auto* cost = new ceres::AutoDiffCostFunction<EdgeCost, 1, 6>(new EdgeCost{e.by_camera, e.off_px, e.sigma_px});
      problem_->AddResidualBlock(cost, &loss_, steps_[projectors_ + e.camera].data());
    }
    for (std::size_t i = 0; i < priors.size(); ++i) {
      auto* cost = new ceres::AutoDiffCostFunction<PriorCost, 6, 6>(new PriorCost{root_of(priors[i].information)});
      problem_->AddResidualBlock(cost, nullptr, steps_[i].data());
    }
  }

  Status solve() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    options.max_num_iterations = 30;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    for (const double stage : kStages) {
      loss_.Reset(new ceres::CauchyLoss(kLossWidth * stage), ceres::TAKE_OWNERSHIP);
      ceres::Solve(options, problem_.get(), &summary);
      if (!summary.IsSolutionUsable()) return Error(ErrorCode::kBadData, "poses were not found: " + summary.message);
    }
    cost_ = summary.final_cost;
    return Done{};
  }

  /// Returns J^T J of all bodies with the losses' weights. Parameter blocks are in the bodies' order.
  [[nodiscard]] Eigen::MatrixXd normal_matrix() {
    ceres::Problem::EvaluateOptions options;
    for (calibration::PoseStep& step : steps_) options.parameter_blocks.push_back(step.data());
    ceres::CRSMatrix jacobian;
    problem_->Evaluate(options, nullptr, nullptr, nullptr, &jacobian);
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(jacobian.num_cols, jacobian.num_cols);
    for (std::size_t row = 0; row + 1 < jacobian.rows.size(); ++row) {
      for (int a = jacobian.rows[row]; a < jacobian.rows[row + 1]; ++a) {
        for (int b = jacobian.rows[row]; b < jacobian.rows[row + 1]; ++b) {
          const auto i = static_cast<std::size_t>(a);
          const auto k = static_cast<std::size_t>(b);
          normal(jacobian.cols[i], jacobian.cols[k]) += jacobian.values[i] * jacobian.values[k];
        }
      }
    }
    return normal;
  }

  /// Returns the median absolute residual of observations relative to that of normal noise.
  [[nodiscard]] double noise() {
    ceres::Problem::EvaluateOptions options;
    options.residual_blocks = seen_;
    options.apply_loss_function = false;
    std::vector<double> residuals;
    problem_->Evaluate(options, nullptr, &residuals, nullptr, nullptr);
    if (residuals.empty()) return 1.0;
    for (double& r : residuals) r = std::abs(r);
    const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
    std::ranges::nth_element(residuals, middle);
    return std::max(1.0, *middle / 0.6745);
  }

  [[nodiscard]] double cost() const { return cost_; }
  [[nodiscard]] const std::vector<calibration::PoseStep>& steps() const { return steps_; }

 private:
  std::size_t projectors_;
  ceres::LossFunctionWrapper loss_;
  std::vector<calibration::PoseStep> steps_;
  std::unique_ptr<ceres::Problem> problem_;
  std::vector<ceres::ResidualBlockId> seen_;
  double cost_ = 0.0;
};

int rank_of(const calibration::PoseMatrix& information) {
  // Scales turns and shifts to units of a loose body's standard deviations.
  calibration::PoseStep unit;
  unit << kLooseTurn_rad, kLooseTurn_rad, kLooseTurn_rad, kLooseShift_m, kLooseShift_m, kLooseShift_m;
  const calibration::PoseMatrix scaled = unit.asDiagonal() * information * unit.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<calibration::PoseMatrix> parts(scaled, Eigen::EigenvaluesOnly);
  return static_cast<int>((parts.eigenvalues().array() > 100.0).count());
}

}  // namespace

calibration::PoseMatrix loose_information() {
  calibration::PoseStep weights;
  weights << Eigen::Vector3d::Constant(1.0 / (kLooseTurn_rad * kLooseTurn_rad)),
      Eigen::Vector3d::Constant(1.0 / (kLooseShift_m * kLooseShift_m));
  return weights.asDiagonal();
}

Result<PoseSolution> solve_poses(const calibration::ShowCalibration& room,
                                 std::span<const PatchObservation> observations, std::span<const EdgeObservation> edges,
                                 std::span<const BodyPrior> priors) {
  CHECK(priors.size() == room.projectors.size() + room.cameras.size());
  if (observations.empty()) return Error(ErrorCode::kInvalidArgument, "no camera saw anything of the show");
  PoseProblem problem(room, observations, edges, priors);
  TRY(problem.solve());
  PoseSolution solution;
  solution.cost = problem.cost();
  solution.noise = problem.noise();
  solution.observations = observations.size();
  const Eigen::LLT<Eigen::MatrixXd> normal(problem.normal_matrix());
  if (normal.info() != Eigen::Success) return Error(ErrorCode::kBadData, "poses without finite covariance");
  const auto size = static_cast<Eigen::Index>(6 * priors.size());
  const Eigen::MatrixXd covariance = normal.solve(Eigen::MatrixXd::Identity(size, size));
  for (std::size_t i = 0; i < priors.size(); ++i) {
    BodySolution body;
    body.step = problem.steps()[i];
    const auto at = static_cast<Eigen::Index>(6 * i);
    const calibration::PoseMatrix block = covariance.block<6, 6>(at, at);
    body.covariance = 0.5 * (block + block.transpose());
    if (!body.covariance.allFinite() || !body.step.allFinite())
      return Error(ErrorCode::kBadData, "poses without finite covariance");
    // Remaining information after subtraction of the prior.
    const calibration::PoseMatrix told = body.covariance.inverse() - priors[i].information;
    const Eigen::SelfAdjointEigenSolver<calibration::PoseMatrix> parts(0.5 * (told + told.transpose()));
    body.information =
        parts.eigenvectors() * parts.eigenvalues().cwiseMax(0.0).asDiagonal() * parts.eigenvectors().transpose();
    body.rank = rank_of(body.information);
    solution.bodies.push_back(body);
  }
  return solution;
}

Result<MovedBodies> find_moved_bodies(const calibration::ShowCalibration& room,
                                      std::span<const PatchObservation> observations,
                                      std::span<const EdgeObservation> edges, std::span<const BodyPrior> priors,
                                      std::span<const calibration::PoseStep> starts, std::size_t max) {
  CHECK(starts.size() == priors.size());
  std::vector<BodyPrior> free(priors.begin(), priors.end());
  MovedBodies movers;
  TRY_ASSIGN(movers.solution, solve_poses(room, observations, edges, free));
  while (movers.bodies.size() < max) {
    std::optional<PoseSolution> best;
    BodyIndex who = 0;
    for (BodyIndex body = 0; body < priors.size(); ++body) {
      if (std::ranges::find(movers.bodies, body) != movers.bodies.end()) continue;
      std::vector<BodyPrior> tried = free;
      tried[body].information = loose_information();
      tried[body].start = starts[body];
      auto solution = solve_poses(room, observations, edges, tried);
      if (!solution || (best && best->cost <= solution->cost)) continue;
      best = *std::move(solution);
      who = body;
    }
    if (!best || !(movers.solution.cost - best->cost > kMinMoveGain)) break;
    free[who].information = loose_information();
    free[who].start = best->bodies[who].step;
    movers.bodies.push_back(who);
    movers.solution = *std::move(best);
  }
  return movers;
}

}  // namespace cyclorama::healing
