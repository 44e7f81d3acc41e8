// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/turntable.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cyclorama::solve {
namespace {

constexpr std::size_t kHeldOutEvery = 5;     // One track in this many is left out.
constexpr double kClearOffset_sigmas = 3.0;  // An offset of less significance is taken as 0.
constexpr double kWorstRms_sigmas = 25.0;    // Larger errors are not noise.

calibration::CalibratedTurntable turntable_of(const TurntableTask& task, const SolvedTurntable& solved,
                                              bool with_offset) {
  calibration::CalibratedTurntable turntable;
  turntable.camera = lens_of(task.measurements, solved.state);
  turntable.pitch_rad = solved.state.mount[0];
  turntable.roll_rad = solved.state.mount[1];
  turntable.offset_m = {solved.state.offset[0], solved.state.offset[1]};
  turntable.inverse_depth = solved.state.inverse_depth.terms;
  if (solved.state.inverse_depth.wall != nullptr) turntable.wall = *solved.state.inverse_depth.wall;
  turntable.angles_rad = solved.state.angles;
  turntable.reference = task.reference;
  turntable.is_offset_estimated = with_offset;
  turntable.parameters = solved.names;
  turntable.covariance = solved.covariance;
  turntable.rank = solved.rank;
  turntable.tracks = solved.tracks;
  turntable.rms_px = solved.used.rms_px;
  turntable.heldout_rms_px = solved.left_out.rms_px;
  if (turntable.covariance.rows() >= calibration::MeasuredLens::kParameters && solved.names.front() == "focal_px") {
    turntable.camera.covariance =
        turntable.covariance
            .topLeftCorner<calibration::MeasuredLens::kParameters, calibration::MeasuredLens::kParameters>();
  }
  return turntable;
}

std::size_t straightest(const Measurements& measurements) {
  std::size_t reference = 0;
  for (std::size_t d = 1; d < measurements.directions.size(); ++d) {
    if (std::abs(measurements.directions[d].angle_rad) < std::abs(measurements.directions[reference].angle_rad)) {
      reference = d;
    }
  }
  return reference;
}

}  // namespace

WallDirections::WallDirections(const calibration::CalibratedTurntable& turntable) : turntable_(turntable) {
  auto lens = turntable.camera.brown();
  if (lens) lens_ = *std::move(lens);
}

std::optional<Eigen::Vector3d> WallDirections::at(std::size_t direction, const Eigen::Vector2d& camera_px) const {
  const auto ray = lens_ ? calibration::direction_through(*lens_, camera_px) : std::nullopt;
  if (!ray) return std::nullopt;
  const CameraPose pose{{turntable_.pitch_rad, turntable_.roll_rad},
                        {turntable_.offset_m.x(), turntable_.offset_m.y()},
                        turntable_.angles_rad[direction]};
  const InverseDepthField inverse_depth{turntable_.inverse_depth, turntable_.wall ? &*turntable_.wall : nullptr};
  const Eigen::Vector3d d = wall_direction_along(pose, inverse_depth, *ray);
  if (!d.allFinite()) return std::nullopt;
  return d;
}

std::optional<Eigen::Vector3d> seen_direction(const calibration::CalibratedTurntable& turntable, std::size_t direction,
                                              const Eigen::Vector2d& camera_px) {
  return WallDirections(turntable).at(direction, camera_px);
}

TurntableSolver::TurntableSolver(const Measurements& measurements, const CellMeans& means,
                                 const TurntableSolverOptions& options, ChosenTracks tracks)
    : measurements_(measurements),
      means_(means),
      options_(options),
      tracks_(std::move(tracks)),
      reference_(straightest(measurements)) {}

Result<TurntableSolver> TurntableSolver::create(const Measurements& measurements, const CellMeans& means,
                                                const TurntableSolverOptions& options) {
  TRY_ASSIGN(ChosenTracks tracks, choose_tracks(measurements, means, options.max_tracks, kHeldOutEvery));
  TurntableSolver solver(measurements, means, options, std::move(tracks));
  TRY_ASSIGN(solver.plain_, solve_turntable_problem(solver.task(), {}, nullptr, Eigen::Vector2d::Zero()));
  return solver;
}

Result<calibration::CalibratedTurntable> TurntableSolver::solve(const TurntableHints& hints) const {
  TRY_ASSIGN(SolvedTurntable moved, solve_turntable_problem(task(), hints, &plain_.state, Eigen::Vector2d::Zero()));
  if (!options_.start.tail<2>().isZero()) {
    auto other = solve_turntable_problem(task(), hints, &plain_.state, options_.start.tail<2>());
    constexpr double kBetter = 1.0 - 1e-6;  // A smaller difference means the same minimum.
    if (other && other->cost < kBetter * moved.cost) moved = *std::move(other);
  }
  const Eigen::Vector2d offset(moved.state.offset[0], moved.state.offset[1]);
  const Eigen::Vector2d sigma = moved.offset_sigma_m();
  const bool is_clear = (offset.cwiseAbs().array() > kClearOffset_sigmas * sigma.array()).any();
  const bool is_known = sigma.maxCoeff() < 0.5 * options_.offset_sigma_m;
  // With known directions no test is made: they constrain the offset better than left-out tracks can test it.
  const bool predicts = hints.known || moved.left_out.rms_px < plain_.left_out.rms_px;
  const bool with_offset = is_clear && predicts;
  const SolvedTurntable& best = with_offset ? moved : plain_;
  if (!(best.used.rms_sigmas < kWorstRms_sigmas) && best.used.rms_px > 2.0) {
    return Error(ErrorCode::kBadData,
                 fmt::format("the directions contradict one another by {:.1f} projector pixels; look whether something "
                             "moved while pictures were taken, and whether angles count to the right",
                             best.used.rms_px));
  }
  calibration::CalibratedTurntable turntable = turntable_of(task(), best, with_offset);
  turntable.offset_sigma_m =
      with_offset ? sigma : Eigen::Vector2d((offset.array().square() + sigma.array().square()).sqrt());
  const std::string found = fmt::format("right {:.1f} +- {:.1f} mm, forward {:.1f} +- {:.1f} mm", 1e3 * offset.x(),
                                        1e3 * sigma.x(), 1e3 * offset.y(), 1e3 * sigma.y());
  const std::string heldout =
      fmt::format("left-out tracks {:.3f} px with it, {:.3f} without", moved.left_out.rms_px, plain_.left_out.rms_px);
  turntable.offset_reason = with_offset              ? fmt::format("estimated: {}; {}", found, heldout)
                            : !is_known && !is_clear ? fmt::format("not observable: {}; taken for 0", found)
                                                     : fmt::format("not needed: {}; {}; taken for 0", found, heldout);
  return turntable;
}

Result<calibration::CalibratedTurntable> solve_turntable(const Measurements& measurements, const CellMeans& means,
                                                         const TurntableSolverOptions& options) {
  TRY_ASSIGN(const TurntableSolver solver, TurntableSolver::create(measurements, means, options));
  return solver.solve();
}

}  // namespace cyclorama::solve
