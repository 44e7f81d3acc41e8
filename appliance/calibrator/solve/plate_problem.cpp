// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibrator/solve/plate_problem.h"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "appliance/calibrator/solve/uncertainty.h"

namespace cyclorama {
namespace {

constexpr double kLoss_sigmas = 2.5;
constexpr double kTurn_rad = 0.05;   // How far what is known of before may still be turned.
constexpr double kWallTrust = 0.03;  // Of a fitted wall's nearness, relative to straight ahead.
constexpr double kLeastNearness_per_m = 1e-6;

/// The mean of what its directions see; nothing when the lens has no place for a pixel.
std::optional<Eigen::Vector3d> mean_sight(const PlateState& state, const BrownLens& lens, const CellMeans& means,
                                          const Track& track) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::size_t i : track.cells) {
    const CellMean& cell = means.cells[i];
    const auto ray = direction_through(lens, cell.camera_px);
    if (!ray) return std::nullopt;
    sum += sight_along(state.camera(static_cast<std::size_t>(cell.direction)), state.nearness, *ray) /
           (cell.sigma_px * cell.sigma_px);
  }
  if (!(sum.norm() > 1e-9)) return std::nullopt;
  return sum.normalized();
}

/// In projector pixels; nothing behind the camera.
std::optional<Eigen::Vector2d> error_px(const PlateState& state, const CellMean& cell, const Eigen::Vector3d& d) {
  Eigen::Vector3d point;
  to_camera(state.mount.data(), state.offset.data(), state.angles[static_cast<std::size_t>(cell.direction)], d.data(),
            state.nearness.at(d), point.data());
  if (!(point.z() > 1e-6)) return std::nullopt;
  Eigen::Vector2d pixel;
  project_through_lens(state.lens.data(), point.data(), pixel.data());
  return cell.camera_per_projector.inverse() * (pixel - cell.camera_px);
}

/// Of tracks whose directions are their means: with n of them, 2n - 2 numbers are free. The worst twentieth is left
/// out, as gross errors are for the decoder to count.
TrackError residual_of(const PlateState& state, const BrownLens& lens, const CellMeans& means,
                       const std::vector<Track>& tracks) {
  std::vector<std::pair<double, double>> squares;
  for (const Track& track : tracks) {
    const auto d = mean_sight(state, lens, means, track);
    if (!d) continue;
    const double free = (static_cast<double>(track.cells.size()) - 1.0) / static_cast<double>(track.cells.size());
    for (const std::size_t i : track.cells) {
      const auto error = error_px(state, means.cells[i], *d);
      if (!error) continue;
      const double square = 0.5 * error->squaredNorm() / free;
      squares.emplace_back(square, square / (means.cells[i].sigma_px * means.cells[i].sigma_px));
    }
  }
  std::sort(squares.begin(), squares.end());
  squares.resize(squares.size() - squares.size() / 20);
  TrackError residual;
  for (const auto& [px, sigmas] : squares) {
    residual.rms_px += px;
    residual.rms_sigmas += sigmas;
  }
  const double count = std::max<double>(1.0, static_cast<double>(squares.size()));
  return {std::sqrt(residual.rms_px / count), std::sqrt(residual.rms_sigmas / count)};
}

Eigen::MatrixXd square_root_of_inverse(const Eigen::MatrixXd& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance);
  const double least = 1e-24 + 1e-18 * std::max(0.0, eigen.eigenvalues().maxCoeff());
  return eigen.eigenvalues().cwiseMax(least).cwiseSqrt().cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose();
}

class PlateProblem {
 public:
  PlateProblem(const PlateTask& task, const PlateHints& hints, bool with_offset, PlateState* state)
      : measurements_(task.measurements), options_(task.options), reference_(task.reference), state_(state) {
    const CellMeans& means = task.means;
    ceres::Problem::Options owned;
    owned.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    problem_ = std::make_unique<ceres::Problem>(owned);
    const auto lens = lens_of(task.measurements, *state).brown();
    for (const Track& track : task.tracks.used) {
      const auto d = lens ? mean_sight(*state, *lens, means, track) : std::nullopt;
      if (!d) continue;
      state->directions.push_back({d->x(), d->y(), d->z()});
      seen_.push_back(&track);
    }
    for (std::size_t t = 0; t < seen_.size(); ++t) {  // Only now do the directions stay where they are.
      const Eigen::Vector3d at(state->directions[t].data());
      for (const std::size_t i : seen_[t]->cells) {
        const CellMean& cell = means.cells[i];
        sights_.push_back(problem_->AddResidualBlock(
            make_sight_cost(cell, state->nearness.wall_at(at)).release(), &loss_, state->lens.data(),
            state->mount.data(), state->offset.data(), &state->angles[static_cast<std::size_t>(cell.direction)],
            state->directions[t].data(), state->nearness.terms.data()));
      }
      problem_->SetManifold(state->directions[t].data(), new ceres::SphereManifold<3>());
      const CellMean& cell = means.cells[seen_[t]->cells.front()];
      const auto known = with_offset && hints.known
                             ? hints.known(static_cast<std::size_t>(cell.projector), cell.projector_px)
                             : std::nullopt;
      if (!known) continue;
      problem_->AddResidualBlock(make_known_sight_cost(*known).release(), &loss_, state->directions[t].data(),
                                 state->turn.data());
    }
    add_priors(with_offset);
  }

  [[nodiscard]] std::size_t tracks() const { return seen_.size(); }

  /// kBadData  no start leads anywhere.
  Result<double> solve() {
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::SPARSE_SCHUR;
    solver.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (auto& d : state_->directions) solver.linear_solver_ordering->AddElementToGroup(d.data(), 0);
    for (double* block : shared_blocks(true)) solver.linear_solver_ordering->AddElementToGroup(block, 1);
    solver.max_num_iterations = 100;
    solver.function_tolerance = 1e-11;
    solver.parameter_tolerance = 1e-12;
    solver.logging_type = ceres::SILENT;
    solver.num_threads = 1;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, problem_.get(), &summary);
    if (summary.IsSolutionUsable()) {
      loss_.Reset(new ceres::CauchyLoss(kLoss_sigmas), ceres::TAKE_OWNERSHIP);
      ceres::Solve(solver, problem_.get(), &summary);
    }
    if (!summary.IsSolutionUsable()) {
      return Error(ErrorCode::kBadData, "the directions cannot be brought together (" + summary.message +
                                            "); look whether the plate's angles turn the right way");
    }
    return summary.final_cost;
  }

  /// Covariance of what all directions share, and the rank of the measurements alone.
  Uncertainty uncertainty() {
    const std::vector<double*> shared = shared_blocks(false);
    std::vector<double*> blocks = shared;
    for (auto& d : state_->directions) blocks.push_back(d.data());
    std::vector<double> scale;  // By the priors, so that ranks do not depend on units.
    for (double* block : shared) {
      for (int i = 0; i < problem_->ParameterBlockTangentSize(block); ++i) scale.push_back(prior_sigma(block, i));
    }
    return uncertainty_of(problem_.get(), blocks, static_cast<int>(scale.size()), 2, scale, sights_);
  }

  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (double* block : shared_blocks(false)) {
      if (block == state_->lens.data()) {
        for (const char* name : {"focal_px", "centre_u_px", "centre_v_px", "k1", "k2", "k3", "p1", "p2"}) {
          names.emplace_back(name);
        }
      } else if (block == state_->mount.data()) {
        names.insert(names.end(), {"pitch_rad", "roll_rad"});
      } else if (block == state_->offset.data()) {
        names.insert(names.end(), {"offset_right_m", "offset_forward_m"});
      } else if (block == state_->nearness.terms.data()) {
        for (int i = 0; i < kNearnessTerms; ++i) names.push_back(fmt::format("nearness_{}_per_m", i));
      } else if (block == state_->turn.data()) {
        names.insert(names.end(), {"turn_right_rad", "turn_up_rad", "turn_back_rad"});
      } else {
        names.push_back(fmt::format("angle_{}_rad", block - state_->angles.data()));
      }
    }
    return names;
  }

 private:
  /// All but the tracks' directions.
  [[nodiscard]] std::vector<double*> shared_blocks(bool with_constant) const {
    std::vector<double*> blocks{state_->lens.data(), state_->mount.data(), state_->offset.data(),
                                state_->nearness.terms.data(), state_->turn.data()};
    for (double& angle : state_->angles) blocks.push_back(&angle);
    std::erase_if(blocks, [&](double* block) {
      return !problem_->HasParameterBlock(block) || (!with_constant && problem_->IsParameterBlockConstant(block));
    });
    return blocks;
  }

  [[nodiscard]] double prior_sigma(const double* block, int i) const {
    if (block == state_->lens.data()) return std::max(1e-12, std::sqrt(measurements_.camera.covariance(i, i)));
    if (block == state_->mount.data()) return options_.mount_sigma_rad;
    if (block == state_->offset.data()) return options_.offset_sigma_m;
    if (block == state_->nearness.terms.data()) return nearness_sigma();
    if (block == state_->turn.data()) return kTurn_rad;
    return measurements_.directions[static_cast<std::size_t>(block - state_->angles.data())].sigma_rad;
  }
  [[nodiscard]] double nearness_sigma() const {
    if (state_->nearness.wall != nullptr) return kWallTrust / measurements_.wall_distance_m;
    return measurements_.wall_distance_sigma_m / (measurements_.wall_distance_m * measurements_.wall_distance_m);
  }

  void add_prior(double* block, const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance) {
    problem_->AddResidualBlock(new ceres::NormalPrior(square_root_of_inverse(covariance), mean), nullptr, block);
  }

  void add_priors(bool with_offset) {
    const auto diagonal = [](int size, double sigma) -> Eigen::MatrixXd {
      return sigma * sigma * Eigen::MatrixXd::Identity(size, size);
    };
    const MeasuredLens& camera = measurements_.camera;
    if (camera.covariance.diagonal().maxCoeff() > 0.0) {
      add_prior(state_->lens.data(), Eigen::Map<const Eigen::VectorXd>(camera.values.data(), MeasuredLens::kParameters),
                camera.covariance);
    } else {
      problem_->SetParameterBlockConstant(state_->lens.data());
    }
    add_prior(state_->mount.data(), Eigen::Vector2d(measurements_.pitch_rad, 0.0),
              diagonal(2, options_.mount_sigma_rad));
    for (std::size_t d = 0; d < state_->angles.size(); ++d) {
      if (!problem_->HasParameterBlock(&state_->angles[d])) continue;
      if (d == reference_) {
        problem_->SetParameterBlockConstant(&state_->angles[d]);
        continue;
      }
      const PlateDirection& direction = measurements_.directions[d];
      add_prior(&state_->angles[d], Eigen::VectorXd::Constant(1, direction.angle_rad),
                diagonal(1, direction.sigma_rad));
    }
    if (with_offset) {
      add_prior(state_->offset.data(), Eigen::Vector2d::Zero(), diagonal(2, options_.offset_sigma_m));
      Eigen::VectorXd mean = Eigen::VectorXd::Zero(kNearnessTerms);
      if (state_->nearness.wall == nullptr) mean[0] = 1.0 / measurements_.wall_distance_m;
      add_prior(state_->nearness.terms.data(), mean, diagonal(kNearnessTerms, nearness_sigma()));
    } else {
      problem_->SetParameterBlockConstant(state_->offset.data());
      problem_->SetParameterBlockConstant(state_->nearness.terms.data());
    }
    if (problem_->HasParameterBlock(state_->turn.data())) {
      add_prior(state_->turn.data(), Eigen::Vector3d::Zero(), diagonal(3, kTurn_rad));
    }
  }

  const Measurements& measurements_;
  const TurnPlateOptions& options_;
  std::size_t reference_;
  PlateState* state_;
  // First one that draws from afar, then one that lets gross errors go.
  ceres::LossFunctionWrapper loss_{new ceres::HuberLoss(kLoss_sigmas), ceres::TAKE_OWNERSHIP};
  std::vector<const Track*> seen_;
  std::vector<ceres::ResidualBlockId> sights_;
  std::unique_ptr<ceres::Problem> problem_;
};

}  // namespace

double NearnessField::wall_at(const Eigen::Vector3d& direction) const {
  return wall == nullptr ? 0.0 : wall->nearness_at(direction).value_or(1.0 / wall->distance_m);
}

double NearnessField::at(const Eigen::Vector3d& direction) const {
  return std::max(kLeastNearness_per_m, wall_at(direction) + nearness_at(terms.data(), direction.data()));
}

Eigen::Vector3d sight_along(const CameraPose& pose, const NearnessField& nearness, const Eigen::Vector3d& ray) {
  const double cr = std::cos(pose.mount[1]);
  const double sr = std::sin(pose.mount[1]);
  const double x = cr * ray.x() - sr * ray.y();
  const double y = -sr * ray.x() - cr * ray.y();
  const double cp = std::cos(pose.mount[0]);
  const double sp = std::sin(pose.mount[0]);
  const double up = cp * y + sp * ray.z();
  const double z = sp * y - cp * ray.z();
  const double ca = std::cos(pose.angle_rad);
  const double sa = std::sin(pose.angle_rad);
  const Eigen::Vector3d seen = Eigen::Vector3d(ca * x - sa * z, up, sa * x + ca * z).normalized();
  const Eigen::Vector3d centre(ca * pose.offset[0] + sa * pose.offset[1], 0.0,
                               sa * pose.offset[0] - ca * pose.offset[1]);
  if (centre.isZero()) return seen;
  Eigen::Vector3d d = seen;
  for (int round = 0; round < 4; ++round) {
    // The wall's point is d / nearness = centre + s seen, for some s: s from its distance, which depends on d.
    const double near = nearness.at(d);
    const double along = centre.dot(seen);
    const double s = -along + std::sqrt(std::max(0.0, along * along + 1.0 / (near * near) - centre.squaredNorm()));
    d = (centre + s * seen).normalized();
  }
  return d;
}

MeasuredLens lens_of(const Measurements& measurements, const PlateState& state) {
  MeasuredLens lens = measurements.camera;
  lens.values = state.lens;
  return lens;
}

Eigen::Vector2d SolvedPlate::offset_sigma_m() const {
  const auto place_of = [this](const char* name) -> Eigen::Index {
    const auto at = std::find(names.begin(), names.end(), name);
    CHECK(at != names.end());
    return at - names.begin();
  };
  // The mean nearness is linear in its terms: their slopes by differences of 1 are exact.
  Eigen::Matrix<double, kNearnessTerms, 1> slopes = Eigen::Matrix<double, kNearnessTerms, 1>::Zero();
  double nearness = 0.0;
  for (const std::array<double, 3>& d : state.directions) {
    nearness += state.nearness.at(Eigen::Vector3d(d.data()));
    for (int i = 0; i < kNearnessTerms; ++i) {
      Nearness unit{};
      unit[static_cast<std::size_t>(i)] = 1.0;
      slopes[i] += nearness_at(unit.data(), d.data());
    }
  }
  const double count = std::max<double>(1.0, static_cast<double>(state.directions.size()));
  nearness = std::max(kLeastNearness_per_m, nearness / count);
  slopes /= count;
  const Eigen::Index terms = place_of("nearness_0_per_m");
  Eigen::Vector2d sigma;
  for (const Eigen::Index axis : {0, 1}) {
    const Eigen::Index at = place_of(axis == 0 ? "offset_right_m" : "offset_forward_m");
    Eigen::VectorXd product = Eigen::VectorXd::Zero(covariance.rows());  // Slopes of offset times nearness.
    product[at] = nearness;
    product.segment<kNearnessTerms>(terms) = state.offset[static_cast<std::size_t>(axis)] * slopes;
    sigma[axis] = std::sqrt(std::max(0.0, product.dot(covariance * product))) / nearness;
  }
  return sigma;
}

Result<SolvedPlate> solve_plate(const PlateTask& task, const PlateHints& hints, const PlateState* from,
                                const Eigen::Vector2d& offset_m) {
  const bool with_offset = from != nullptr;
  SolvedPlate solved;
  PlateState& state = solved.state;
  state.lens = task.measurements.camera.values;
  state.mount = {task.measurements.pitch_rad + task.options.start[0], task.options.start[1]};
  for (const PlateDirection& direction : task.measurements.directions) state.angles.push_back(direction.angle_rad);
  if (with_offset) {  // From where the camera is without one: two unknowns that are small count little there.
    state.lens = from->lens;
    state.mount = from->mount;
    state.angles = from->angles;
  }
  state.offset = {offset_m.x(), offset_m.y()};
  state.nearness.wall = with_offset ? hints.wall : nullptr;
  if (state.nearness.wall == nullptr) state.nearness.terms[0] = 1.0 / task.measurements.wall_distance_m;
  state.directions.reserve(task.tracks.used.size());
  {
    PlateProblem problem(task, hints, with_offset, &state);
    if (problem.tracks() < kLeastTracks) {
      return Error(
          ErrorCode::kInvalidArgument,
          "the camera's lens has no directions for the pixels that several pictures share; calibrate the lens");
    }
    TRY_ASSIGN(solved.cost, problem.solve());
    const Uncertainty uncertainty = problem.uncertainty();
    solved.covariance = uncertainty.covariance;
    solved.rank = uncertainty.rank;
    solved.names = problem.names();
    solved.tracks = problem.tracks();
  }
  auto lens = lens_of(task.measurements, state).brown();
  if (!lens) return std::move(lens).error().while_doing("solving the turn-plate");
  solved.used = residual_of(state, *lens, task.means, task.tracks.used);
  solved.left_out = residual_of(state, *lens, task.means, task.tracks.left_out);
  return solved;
}

}  // namespace cyclorama
