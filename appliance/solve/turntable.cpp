// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/turntable.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cyclorama::solve {
namespace {

constexpr std::size_t kHeldOutEvery = 5;     // One track in this many is left out.
constexpr double kClearOffset_sigmas = 3.0;  // Below this significance the offset is taken to be 0.
constexpr double kWorstRms_sigmas = 25.0;    // Larger errors are not noise.

calibration::TurnPlate plate_of(const PlateTask& task, const SolvedPlate& solved, bool with_offset) {
  calibration::TurnPlate plate;
  plate.camera = lens_of(task.measurements, solved.state);
  plate.pitch_rad = solved.state.mount[0];
  plate.roll_rad = solved.state.mount[1];
  plate.offset_m = {solved.state.offset[0], solved.state.offset[1]};
  plate.inverse_depth = solved.state.inverse_depth.terms;
  if (solved.state.inverse_depth.wall != nullptr) plate.wall = *solved.state.inverse_depth.wall;
  plate.angles_rad = solved.state.angles;
  plate.reference = task.reference;
  plate.is_offset_estimated = with_offset;
  plate.parameters = solved.names;
  plate.covariance = solved.covariance;
  plate.rank = solved.rank;
  plate.tracks = solved.tracks;
  plate.rms_px = solved.used.rms_px;
  plate.heldout_rms_px = solved.left_out.rms_px;
  if (plate.covariance.rows() >= calibration::MeasuredLens::kParameters && solved.names.front() == "focal_px") {
    plate.camera.covariance =
        plate.covariance
            .topLeftCorner<calibration::MeasuredLens::kParameters, calibration::MeasuredLens::kParameters>();
  }
  return plate;
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

WallDirections::WallDirections(const calibration::TurnPlate& plate) : plate_(plate) {
  auto lens = plate.camera.brown();
  if (lens) lens_ = *std::move(lens);
}

std::optional<Eigen::Vector3d> WallDirections::at(std::size_t direction, const Eigen::Vector2d& camera_px) const {
  const auto ray = lens_ ? calibration::direction_through(*lens_, camera_px) : std::nullopt;
  if (!ray) return std::nullopt;
  const CameraPose pose{
      {plate_.pitch_rad, plate_.roll_rad}, {plate_.offset_m.x(), plate_.offset_m.y()}, plate_.angles_rad[direction]};
  const InverseDepthField inverse_depth{plate_.inverse_depth, plate_.wall ? &*plate_.wall : nullptr};
  const Eigen::Vector3d d = wall_direction_along(pose, inverse_depth, *ray);
  if (!d.allFinite()) return std::nullopt;
  return d;
}

std::optional<Eigen::Vector3d> seen_direction(const calibration::TurnPlate& plate, std::size_t direction,
                                              const Eigen::Vector2d& camera_px) {
  return WallDirections(plate).at(direction, camera_px);
}

TurnPlateSolver::TurnPlateSolver(const Measurements& measurements, const CellMeans& means,
                                 const TurnPlateOptions& options, ChosenTracks tracks)
    : measurements_(measurements),
      means_(means),
      options_(options),
      tracks_(std::move(tracks)),
      reference_(straightest(measurements)) {}

Result<TurnPlateSolver> TurnPlateSolver::create(const Measurements& measurements, const CellMeans& means,
                                                const TurnPlateOptions& options) {
  TRY_ASSIGN(ChosenTracks tracks, choose_tracks(measurements, means, options.max_tracks, kHeldOutEvery));
  TurnPlateSolver solver(measurements, means, options, std::move(tracks));
  TRY_ASSIGN(solver.plain_, solve_plate(solver.task(), {}, nullptr, Eigen::Vector2d::Zero()));
  return solver;
}

Result<calibration::TurnPlate> TurnPlateSolver::solve(const PlateHints& hints) const {
  TRY_ASSIGN(SolvedPlate moved, solve_plate(task(), hints, &plain_.state, Eigen::Vector2d::Zero()));
  if (!options_.start.tail<2>().isZero()) {
    auto other = solve_plate(task(), hints, &plain_.state, options_.start.tail<2>());
    constexpr double kBetter = 1.0 - 1e-6;  // A smaller difference is the same minimum, reached less exactly.
    if (other && other->cost < kBetter * moved.cost) moved = *std::move(other);
  }
  const Eigen::Vector2d offset(moved.state.offset[0], moved.state.offset[1]);
  const Eigen::Vector2d sigma = moved.offset_sigma_m();
  const bool is_clear = (offset.cwiseAbs().array() > kClearOffset_sigmas * sigma.array()).any();
  const bool is_known = sigma.maxCoeff() < 0.5 * options_.offset_sigma_m;
  // Known directions constrain the offset more than the tracks do.
  const bool predicts = hints.known || moved.left_out.rms_px < plain_.left_out.rms_px;
  const bool with_offset = is_clear && predicts;
  const SolvedPlate& best = with_offset ? moved : plain_;
  if (!(best.used.rms_sigmas < kWorstRms_sigmas) && best.used.rms_px > 2.0) {
    return Error(ErrorCode::kBadData,
                 fmt::format("the directions contradict one another by {:.1f} projector pixels; look whether something "
                             "moved while pictures were taken, and whether angles count to the right",
                             best.used.rms_px));
  }
  calibration::TurnPlate plate = plate_of(task(), best, with_offset);
  plate.offset_sigma_m =
      with_offset ? sigma : Eigen::Vector2d((offset.array().square() + sigma.array().square()).sqrt());
  const std::string found = fmt::format("right {:.1f} +- {:.1f} mm, forward {:.1f} +- {:.1f} mm", 1e3 * offset.x(),
                                        1e3 * sigma.x(), 1e3 * offset.y(), 1e3 * sigma.y());
  const std::string heldout =
      fmt::format("left-out tracks {:.3f} px with it, {:.3f} without", moved.left_out.rms_px, plain_.left_out.rms_px);
  plate.offset_reason = with_offset              ? fmt::format("estimated: {}; {}", found, heldout)
                        : !is_known && !is_clear ? fmt::format("not observable: {}; taken for 0", found)
                                                 : fmt::format("not needed: {}; {}; taken for 0", found, heldout);
  return plate;
}

Result<calibration::TurnPlate> solve_turn_plate(const Measurements& measurements, const CellMeans& means,
                                                const TurnPlateOptions& options) {
  TRY_ASSIGN(const TurnPlateSolver solver, TurnPlateSolver::create(measurements, means, options));
  return solver.solve();
}

}  // namespace cyclorama::solve
