// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibrator/solve/turn_plate.h"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

#include "appliance/calibrator/solve/tracks.h"
#include "appliance/calibrator/solve/uncertainty.h"

namespace cyclorama {
namespace {

constexpr double kLoss_sigmas = 2.5;
constexpr std::size_t kHeldOutEvery = 5;     // One track in so many is left out.
constexpr double kClearOffset_sigmas = 3.0;  // Else it is taken for 0.
constexpr double kWorstRms_sigmas = 25.0;    // More is no noise.

/// What the bundle adjustment moves. Ceres holds pointers into it.
struct State {
  std::array<double, MeasuredLens::kParameters> lens{};
  std::array<double, 2> mount{};
  std::array<double, 2> offset{};
  std::vector<double> angles;
  Nearness nearness{};
  std::vector<std::array<double, 3>> directions;  ///< Of the tracks.
};

Eigen::Vector3d from_camera(const State& state, std::size_t direction, const Eigen::Vector3d& ray) {
  const double cr = std::cos(state.mount[1]);
  const double sr = std::sin(state.mount[1]);
  const double x = cr * ray.x() - sr * ray.y();
  const double y = -sr * ray.x() - cr * ray.y();
  const double cp = std::cos(state.mount[0]);
  const double sp = std::sin(state.mount[0]);
  const double up = cp * y + sp * ray.z();
  const double z = sp * y - cp * ray.z();
  const double ca = std::cos(state.angles[direction]);
  const double sa = std::sin(state.angles[direction]);
  return {ca * x - sa * z, up, sa * x + ca * z};
}

/// With the camera's offset: the wall's nearness there decides, which itself depends on the direction.
Eigen::Vector3d sight(const State& state, std::size_t direction, const Eigen::Vector3d& ray) {
  const Eigen::Vector3d seen = from_camera(state, direction, ray).normalized();
  const double ca = std::cos(state.angles[direction]);
  const double sa = std::sin(state.angles[direction]);
  const Eigen::Vector3d centre(ca * state.offset[0] + sa * state.offset[1], 0.0,
                               sa * state.offset[0] - ca * state.offset[1]);
  Eigen::Vector3d d = seen;
  for (int round = 0; round < 4; ++round) {
    // The wall's point is d / nearness = centre + s seen, for some s: s from its distance.
    const double near = std::max(1e-6, nearness_at(state.nearness.data(), d.data()));
    const double along = centre.dot(seen);
    const double s = -along + std::sqrt(std::max(0.0, along * along + 1.0 / (near * near) - centre.squaredNorm()));
    d = (centre + s * seen).normalized();
  }
  return d;
}

State start_of(const Measurements& measurements, const TurnPlateOptions& options) {
  State state;
  state.lens = measurements.camera.values;
  state.mount = {measurements.pitch_rad + options.start[0], options.start[1]};
  state.offset = {options.start[2], options.start[3]};
  for (const PlateDirection& direction : measurements.directions) state.angles.push_back(direction.angle_rad);
  state.nearness = {};
  state.nearness[0] = 1.0 / measurements.wall_distance_m;
  return state;
}

MeasuredLens lens_of(const Measurements& measurements, const State& state) {
  MeasuredLens lens = measurements.camera;
  lens.values = state.lens;
  return lens;
}

/// The mean of what its directions see; nothing when the lens has no place for a pixel.
std::optional<Eigen::Vector3d> mean_sight(const State& state, const MeasuredLens& lens, const CellMeans& means,
                                          const Track& track) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::size_t i : track.cells) {
    const CellMean& cell = means.cells[i];
    const auto ray = lens.direction_at(cell.camera_px);
    if (!ray) return std::nullopt;
    sum += sight(state, static_cast<std::size_t>(cell.direction), *ray) / (cell.sigma_px * cell.sigma_px);
  }
  if (!(sum.norm() > 1e-9)) return std::nullopt;
  return sum.normalized();
}

/// In projector pixels; nothing behind the camera.
std::optional<Eigen::Vector2d> error_px(const State& state, const CellMean& cell, const Eigen::Vector3d& d) {
  Eigen::Vector3d point;
  to_camera(state.mount.data(), state.offset.data(), state.angles[static_cast<std::size_t>(cell.direction)], d.data(),
            nearness_at(state.nearness.data(), d.data()), point.data());
  if (!(point.z() > 1e-6)) return std::nullopt;
  Eigen::Vector2d pixel;
  project_through_lens(state.lens.data(), point.data(), pixel.data());
  return cell.camera_per_projector.inverse() * (pixel - cell.camera_px);
}

struct Residual {
  double rms_px = 0.0;
  double rms_sigmas = 0.0;
};

/// Of tracks whose directions are their means: with n of them, 2n - 2 numbers are free. The worst twentieth is left
/// out, as gross errors are for the decoder to count.
Residual residual_of(const State& state, const MeasuredLens& lens, const CellMeans& means,
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
  Residual residual;
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
  PlateProblem(const Measurements& measurements, const CellMeans& means, const TurnPlateOptions& options,
               const std::vector<Track>& tracks, std::size_t reference, bool with_offset, State* state)
      : measurements_(measurements), options_(options), reference_(reference), state_(state) {
    ceres::Problem::Options owned;
    owned.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    problem_ = std::make_unique<ceres::Problem>(owned);
    const MeasuredLens lens = lens_of(measurements, *state);
    for (const Track& track : tracks) {
      const auto d = mean_sight(*state, lens, means, track);
      if (!d) continue;
      state->directions.push_back({d->x(), d->y(), d->z()});
      seen_.push_back(&track);
    }
    for (std::size_t t = 0; t < seen_.size(); ++t) {  // Only now do the directions stay where they are.
      for (const std::size_t i : seen_[t]->cells) {
        const CellMean& cell = means.cells[i];
        sights_.push_back(problem_->AddResidualBlock(make_sight_cost(cell).release(), &loss_, state->lens.data(),
                                                     state->mount.data(), state->offset.data(),
                                                     &state->angles[static_cast<std::size_t>(cell.direction)],
                                                     state->directions[t].data(), state->nearness.data()));
      }
      problem_->SetManifold(state->directions[t].data(), new ceres::SphereManifold<3>());
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
      } else if (block == state_->nearness.data()) {
        for (int i = 0; i < kNearnessTerms; ++i) names.push_back(fmt::format("nearness_{}_per_m", i));
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
                                state_->nearness.data()};
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
    if (block == state_->nearness.data()) return nearness_sigma();
    return measurements_.directions[static_cast<std::size_t>(block - state_->angles.data())].sigma_rad;
  }
  [[nodiscard]] double nearness_sigma() const {
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
      mean[0] = 1.0 / measurements_.wall_distance_m;
      add_prior(state_->nearness.data(), mean, diagonal(kNearnessTerms, nearness_sigma()));
    } else {
      problem_->SetParameterBlockConstant(state_->offset.data());
      problem_->SetParameterBlockConstant(state_->nearness.data());
    }
  }

  const Measurements& measurements_;
  const TurnPlateOptions& options_;
  std::size_t reference_;
  State* state_;
  // First one that draws from afar, then one that lets gross errors go.
  ceres::LossFunctionWrapper loss_{new ceres::HuberLoss(kLoss_sigmas), ceres::TAKE_OWNERSHIP};
  std::vector<const Track*> seen_;
  std::vector<ceres::ResidualBlockId> sights_;
  std::unique_ptr<ceres::Problem> problem_;
};

struct Solved {
  State state;
  double cost = 0.0;
  Uncertainty uncertainty;
  std::vector<std::string> names;
  std::size_t tracks = 0;
  Residual used;
  Residual left_out;
};

Result<Solved> solve_once(const Measurements& measurements, const CellMeans& means, const TurnPlateOptions& options,
                          const ChosenTracks& tracks, std::size_t reference, const State* from,
                          const Eigen::Vector2d& offset_m) {
  const bool with_offset = from != nullptr;
  Solved solved;
  solved.state = start_of(measurements, options);
  if (with_offset) {  // From where the camera is without one: two unknowns that are small count little there.
    solved.state.lens = from->lens;
    solved.state.mount = from->mount;
    solved.state.angles = from->angles;
  }
  solved.state.offset = {offset_m.x(), offset_m.y()};
  solved.state.directions.reserve(tracks.used.size());
  {
    PlateProblem problem(measurements, means, options, tracks.used, reference, with_offset, &solved.state);
    if (problem.tracks() < kLeastTracks) {
      return Error(
          ErrorCode::kInvalidArgument,
          "the camera's lens has no directions for the pixels that several pictures share; calibrate the lens");
    }
    TRY_ASSIGN(solved.cost, problem.solve());
    solved.uncertainty = problem.uncertainty();
    solved.names = problem.names();
    solved.tracks = problem.tracks();
  }
  const MeasuredLens lens = lens_of(measurements, solved.state);
  solved.used = residual_of(solved.state, lens, means, tracks.used);
  solved.left_out = residual_of(solved.state, lens, means, tracks.left_out);
  return solved;
}

TurnPlate plate_of(const Measurements& measurements, const Solved& solved, std::size_t reference, bool with_offset) {
  TurnPlate plate;
  plate.camera = lens_of(measurements, solved.state);
  plate.pitch_rad = solved.state.mount[0];
  plate.roll_rad = solved.state.mount[1];
  plate.offset_m = {solved.state.offset[0], solved.state.offset[1]};
  plate.nearness = solved.state.nearness;
  plate.angles_rad = solved.state.angles;
  plate.reference = reference;
  plate.is_offset_estimated = with_offset;
  plate.parameters = solved.names;
  plate.covariance = solved.uncertainty.covariance;
  plate.rank = solved.uncertainty.rank;
  plate.tracks = solved.tracks;
  plate.rms_px = solved.used.rms_px;
  plate.heldout_rms_px = solved.left_out.rms_px;
  if (plate.covariance.rows() >= MeasuredLens::kParameters && solved.names.front() == "focal_px") {
    plate.camera.covariance = plate.covariance.topLeftCorner<MeasuredLens::kParameters, MeasuredLens::kParameters>();
  }
  return plate;
}

/// Where a parameter stands in the covariance.
double sigma_of(const Solved& solved, const std::string& name) {
  const auto at = std::find(solved.names.begin(), solved.names.end(), name);
  CHECK(at != solved.names.end());
  const auto i = at - solved.names.begin();
  return std::sqrt(std::max(0.0, solved.uncertainty.covariance(i, i)));
}

}  // namespace

std::optional<Eigen::Vector3d> TurnPlate::sight_of(std::size_t direction, const Eigen::Vector2d& camera_px) const {
  const auto ray = camera.direction_at(camera_px);
  if (!ray) return std::nullopt;
  State state;
  state.mount = {pitch_rad, roll_rad};
  state.offset = {offset_m.x(), offset_m.y()};
  state.angles = angles_rad;
  state.nearness = nearness;
  const Eigen::Vector3d d = sight(state, direction, *ray);
  if (!d.allFinite()) return std::nullopt;
  return d;
}

Result<TurnPlate> solve_turn_plate(const Measurements& measurements, const CellMeans& means,
                                   const TurnPlateOptions& options) {
  TRY_ASSIGN(const ChosenTracks tracks, choose_tracks(measurements, means, options.most_tracks, kHeldOutEvery));
  std::size_t reference = 0;
  for (std::size_t d = 1; d < measurements.directions.size(); ++d) {
    if (std::abs(measurements.directions[d].angle_rad) < std::abs(measurements.directions[reference].angle_rad)) {
      reference = d;
    }
  }
  TRY_ASSIGN(Solved plain,
             solve_once(measurements, means, options, tracks, reference, nullptr, Eigen::Vector2d::Zero()));
  TRY_ASSIGN(Solved moved,
             solve_once(measurements, means, options, tracks, reference, &plain.state, Eigen::Vector2d::Zero()));
  if (!options.start.tail<2>().isZero()) {
    auto other = solve_once(measurements, means, options, tracks, reference, &plain.state, options.start.tail<2>());
    constexpr double kBetter = 1.0 - 1e-6;  // Else it is the same place, not quite reached.
    if (other && other->cost < kBetter * moved.cost) moved = *std::move(other);
  }
  const double right = moved.state.offset[0];
  const double forward = moved.state.offset[1];
  const double sigma_right = sigma_of(moved, "offset_right_m");
  const double sigma_forward = sigma_of(moved, "offset_forward_m");
  const bool is_clear =
      std::abs(right) > kClearOffset_sigmas * sigma_right || std::abs(forward) > kClearOffset_sigmas * sigma_forward;
  const bool is_known = std::max(sigma_right, sigma_forward) < 0.5 * options.offset_sigma_m;
  const bool predicts = moved.left_out.rms_px < plain.left_out.rms_px;
  const bool with_offset = is_clear && predicts;
  const Solved& best = with_offset ? moved : plain;
  if (!(best.used.rms_sigmas < kWorstRms_sigmas) && best.used.rms_px > 2.0) {
    return Error(ErrorCode::kBadData,
                 fmt::format("the directions contradict one another by {:.1f} projector pixels; look whether something "
                             "moved while pictures were taken, and whether angles count to the right",
                             best.used.rms_px));
  }
  TurnPlate plate = plate_of(measurements, best, reference, with_offset);
  const std::string found = fmt::format("right {:.1f} +- {:.1f} mm, forward {:.1f} +- {:.1f} mm", 1e3 * right,
                                        1e3 * sigma_right, 1e3 * forward, 1e3 * sigma_forward);
  const std::string heldout =
      fmt::format("left-out tracks {:.3f} px with it, {:.3f} without", moved.left_out.rms_px, plain.left_out.rms_px);
  plate.offset_reason = with_offset              ? fmt::format("estimated: {}; {}", found, heldout)
                        : !is_known && !is_clear ? fmt::format("not observable: {}; taken for 0", found)
                                                 : fmt::format("not needed: {}; {}; taken for 0", found, heldout);
  return plate;
}

}  // namespace cyclorama
