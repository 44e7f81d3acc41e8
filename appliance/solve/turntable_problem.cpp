// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/turntable_problem.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "appliance/solve/turntable_adjustment.h"
#include "appliance/solve/uncertainty.h"

namespace cyclorama::solve {
namespace {

constexpr double kMinInverseDepth_per_m = 1e-6;
constexpr DampedOptions kSteps{100, 1e-11, 1e-12};

/// Returns the mean of the directions of a track's observations; nothing if a pixel is outside the lens's domain.
std::optional<Eigen::Vector3d> mean_direction(const TurntableState& state, const calibration::BrownLens& lens,
                                              const CellMeans& means, const Track& track) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::size_t i : track.cells) {
    const CellMean& cell = means.cells[i];
    const auto ray = calibration::direction_through(lens, cell.camera_px);
    if (!ray) return std::nullopt;
    sum += wall_direction_along(state.camera(static_cast<std::size_t>(cell.direction)), state.inverse_depth, *ray) /
           (cell.sigma_px * cell.sigma_px);
  }
  if (!(sum.norm() > 1e-9)) return std::nullopt;
  return sum.normalized();
}

/// Returns the error in projector pixels; nothing if the point is behind the camera.
std::optional<Eigen::Vector2d> error_px(const TurntableState& state, const CellMean& cell, const Eigen::Vector3d& d) {
  Eigen::Vector3d point;
  to_camera(state.mount.data(), state.offset.data(), state.angles[static_cast<std::size_t>(cell.direction)], d.data(),
            state.inverse_depth.at(d), point.data());
  if (!(point.z() > 1e-6)) return std::nullopt;
  Eigen::Vector2d pixel;
  calibration::project_through_lens(state.lens.data(), point.data(), pixel.data());
  return cell.camera_per_projector.inverse() * (pixel - cell.camera_px);
}

/// Returns the residual of tracks, without the worst twentieth. The direction of a track is the mean of its n
/// observations, so 2n - 2 degrees of freedom remain.
TrackError residual_of(const TurntableState& state, const calibration::BrownLens& lens, const CellMeans& means,
                       const std::vector<Track>& tracks) {
  std::vector<std::pair<double, double>> squares;
  for (const Track& track : tracks) {
    const auto d = mean_direction(state, lens, means, track);
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

}  // namespace

double InverseDepthField::wall_at(const Eigen::Vector3d& direction) const {
  return wall == nullptr ? 0.0 : wall->inverse_depth_at(direction).value_or(1.0 / wall->distance_m);
}

double InverseDepthField::at(const Eigen::Vector3d& direction) const {
  return std::max(kMinInverseDepth_per_m, wall_at(direction) + inverse_depth_at(terms, direction));
}

Eigen::Vector3d wall_direction_along(const CameraPose& pose, const InverseDepthField& inverse_depth,
                                     const Eigen::Vector3d& ray) {
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
    // The wall point is d / inverse_depth = centre + s * seen. The length s follows from the point's distance 1 / near,
    // which depends on d.
    const double near = inverse_depth.at(d);
    const double along = centre.dot(seen);
    const double s = -along + std::sqrt(std::max(0.0, along * along + 1.0 / (near * near) - centre.squaredNorm()));
    d = (centre + s * seen).normalized();
  }
  return d;
}

calibration::MeasuredLens lens_of(const Measurements& measurements, const TurntableState& state) {
  calibration::MeasuredLens lens = measurements.camera;
  lens.values = state.lens;
  return lens;
}

Eigen::Vector2d SolvedTurntable::offset_sigma_m() const {
  const auto place_of = [this](const char* name) -> Eigen::Index {
    const auto at = std::find(names.begin(), names.end(), name);
    CHECK(at != names.end());
    return at - names.begin();
  };
  Eigen::Matrix<double, calibration::kInverseDepthTerms, 1> slopes =
      Eigen::Matrix<double, calibration::kInverseDepthTerms, 1>::Zero();
  double inverse_depth = 0.0;
  for (const std::array<double, 3>& d : state.directions) {
    const Eigen::Vector3d direction(d.data());
    inverse_depth += state.inverse_depth.at(direction);
    slopes += inverse_depth_basis(direction);
  }
  const double count = std::max<double>(1.0, static_cast<double>(state.directions.size()));
  inverse_depth = std::max(kMinInverseDepth_per_m, inverse_depth / count);
  slopes /= count;
  const Eigen::Index terms = place_of("inverse_depth_0_per_m");
  Eigen::Vector2d sigma;
  for (const Eigen::Index axis : {0, 1}) {
    const Eigen::Index at = place_of(axis == 0 ? "offset_right_m" : "offset_forward_m");
    Eigen::VectorXd product = Eigen::VectorXd::Zero(covariance.rows());  // Gradient of offset times inverse depth.
    product[at] = inverse_depth;
    product.segment<calibration::kInverseDepthTerms>(terms) = state.offset[static_cast<std::size_t>(axis)] * slopes;
    sigma[axis] = std::sqrt(std::max(0.0, product.dot(covariance * product))) / inverse_depth;
  }
  return sigma;
}

Result<SolvedTurntable> solve_turntable_problem(const TurntableTask& task, const TurntableHints& hints,
                                                const TurntableState* from, const Eigen::Vector2d& offset_m) {
  const bool with_offset = from != nullptr;
  SolvedTurntable solved;
  TurntableState& state = solved.state;
  state.lens = task.measurements.camera.values;
  state.mount = {task.measurements.pitch_rad + task.options.start[0], task.options.start[1]};
  for (const TurntableDirection& direction : task.measurements.directions) state.angles.push_back(direction.angle_rad);
  if (with_offset) {  // Starts from the solution without an offset, which two small further unknowns change little.
    state.lens = from->lens;
    state.mount = from->mount;
    state.angles = from->angles;
  }
  state.offset = {offset_m.x(), offset_m.y()};
  state.inverse_depth.wall = with_offset ? hints.wall : nullptr;
  if (state.inverse_depth.wall == nullptr) state.inverse_depth.terms[0] = 1.0 / task.measurements.wall_distance_m;
  std::vector<const Track*> tracks;
  if (const auto lens = lens_of(task.measurements, state).brown()) {
    for (const Track& track : task.tracks.used) {
      const auto d = mean_direction(state, *lens, task.means, track);
      if (!d) continue;
      state.directions.push_back({d->x(), d->y(), d->z()});
      tracks.push_back(&track);
    }
  }
  if (tracks.size() < kMinTracks) {
    return Error(ErrorCode::kInvalidArgument,
                 "the camera's lens has no directions for the pixels that several pictures share; calibrate the lens");
  }
  TurntableAdjustment adjustment(task, hints, with_offset, tracks, &state);
  const auto cost = minimise_robustly(&adjustment, true, kSteps);
  if (!cost) {
    return Error(ErrorCode::kBadData,
                 "the directions do not fit together; check that the turntable turns the right way");
  }
  solved.cost = *cost;
  const Uncertainty uncertainty =
      uncertainty_of(adjustment.reduced_normal(false), adjustment.reduced_normal(true), adjustment.prior_sigmas());
  solved.covariance = uncertainty.covariance;
  solved.rank = uncertainty.rank;
  solved.names = adjustment.names();
  solved.tracks = tracks.size();
  auto lens = lens_of(task.measurements, state).brown();
  if (!lens) return std::move(lens).error().while_doing("solving the turntable");
  solved.used = residual_of(state, *lens, task.means, task.tracks.used);
  solved.left_out = residual_of(state, *lens, task.means, task.tracks.left_out);
  return solved;
}

}  // namespace cyclorama::solve
