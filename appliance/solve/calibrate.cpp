// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/calibrate.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <future>
#include <limits>

#include "appliance/solve/registration.h"

namespace cyclorama::solve {
namespace {

constexpr double kWallFloor_px = 0.05;  // Added to a sample's sigma: residual errors of the lens models.
// An old map stays valid if its error on new measurements is at most this multiple of the new map's error on left-out
// ones; such errors scatter by some percent over some hundred correspondences.
constexpr double kStillRight = 1.1;
// Largest ratio of the old maps' errors to the new maps' at which all old maps may be kept together. The old maps'
// systematic error is then at most three quarters of the new maps' scatter, since 1.25² = 1 + 0.75².
constexpr double kHardlyWorse = 1.25;
/// A smaller ratio of registrations is within the scatter of single correspondences, and no evidence of motion.
constexpr double kRegistersAsWell = 1.02;
/// Maximum fraction of the new measurements for which only the old map has no direction; the maps' rims differ
/// slightly.
constexpr double kMaxUnknownShare = 0.01;
constexpr double kMaxUnremarkedError_px = 0.5;  // A map with a larger left-out error gets a remark.
// A hint is wrong if it increases the error of left-out tracks by more than this factor; such errors scatter by some
// percent.
constexpr double kHintAgrees = 1.02;
constexpr int kRefitSteps = 20;
constexpr double kKnownFloor_px = 0.1;  // Added to the sigma of an old map's direction, since a map's cells are flat.

using Samples = std::vector<std::vector<MapSample>>;  // Indexed by projector.

Samples samples_of(const Measurements& measurements, const CellMeans& means,
                   const calibration::CalibratedTurntable& turntable) {
  Samples samples(measurements.projectors.size());
  const WallDirections observations(turntable);
  for (const CellMean& cell : means.cells) {
    const auto d = observations.at(static_cast<std::size_t>(cell.direction), cell.camera_px);
    if (d) samples[static_cast<std::size_t>(cell.projector)].push_back({cell.projector_px, *d, cell.sigma_px});
  }
  return samples;
}

const calibration::CalibratedProjector* projector_of(const calibration::Calibration* calibration,
                                                     const std::string& name) {
  if (calibration == nullptr) return nullptr;
  const auto at = std::find_if(calibration->projectors.begin(), calibration->projectors.end(),
                               [&](const calibration::CalibratedProjector& p) { return p.name == name; });
  return at == calibration->projectors.end() ? nullptr : &*at;
}

/// Returns the rotation from directions of the previous calibration to new ones: each calibration estimates the
/// turntable's heading and tilt anew. Robust against displaced projectors.
Eigen::Matrix3d turn_of(const calibration::Calibration& before, const Measurements& measurements,
                        const Samples& samples) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> pairs;
  for (std::size_t p = 0; p < samples.size(); ++p) {
    const calibration::CalibratedProjector* projector = projector_of(&before, measurements.projectors[p].name);
    if (projector == nullptr) continue;
    for (std::size_t i = 0; i < samples[p].size(); i += 7) {
      const auto d = projector->map.direction_at(samples[p][i].projector_px);
      if (d) pairs.emplace_back(*d, samples[p][i].direction);
    }
  }
  for (int round = 0; round < 4 && !pairs.empty(); ++round) {
    std::vector<double> far;
    for (const auto& [a, b] : pairs) far.push_back((turn * a - b).norm());
    std::vector<double> sorted = far;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(far.size() / 2), sorted.end());
    const double reach = 2.0 * sorted[far.size() / 2] + 1e-9;
    Eigen::Matrix3d together = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (far[i] <= reach) together += pairs[i].first * pairs[i].second.transpose();
    }
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(together, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double sign = (svd.matrixV() * svd.matrixU().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
    turn = svd.matrixV() * Eigen::Vector3d(1.0, 1.0, sign).asDiagonal() * svd.matrixU().transpose();
  }
  return turn;
}

calibration::MeasuredMap turned(const calibration::MeasuredMap& map, const Eigen::Matrix3d& turn) {
  calibration::MeasuredMap moved = map;
  for (Eigen::Vector3d& d : moved.directions) d = Eigen::Vector3d(turn * d);
  return moved;
}

/// Returns a few samples, spread evenly over each projector's picture.
std::vector<MapSample> wall_samples(const Samples& samples, std::size_t count) {
  std::vector<MapSample> chosen;
  const std::size_t each = std::max<std::size_t>(1, count / std::max<std::size_t>(1, samples.size()));
  for (std::size_t p = 0; p < samples.size(); ++p) {
    if (samples[p].empty()) continue;
    // A step that is coprime to the rows' length scatters the samples.
    std::size_t step = std::max<std::size_t>(1, samples[p].size() / each);
    if (step > 1 && step % 2 == 0) ++step;
    for (std::size_t i = 0; i < samples[p].size(); i += step) {
      const MapSample& s = samples[p][i];
      chosen.push_back({s.projector_px, s.direction, std::hypot(s.sigma_px, kWallFloor_px), p});
    }
  }
  return chosen;
}

/// Returns a pixel's direction by a previous map, as a further reference for the camera's pose.
std::optional<KnownDirection> known_direction(const calibration::MeasuredMap& map, const Eigen::Matrix3d& turn,
                                              const Eigen::Vector2d& pixel) {
  const auto at = map.direction_at(pixel);
  const auto beside = map.direction_at(pixel + Eigen::Vector2d(1.0, 0.0));
  if (!at || !beside) return std::nullopt;
  const double sigma_rad = std::hypot(map.sigma_at(pixel), kKnownFloor_px) * (*beside - *at).norm();
  if (!(sigma_rad > 1e-9) || !std::isfinite(sigma_rad)) return std::nullopt;
  return KnownDirection{turn * *at, sigma_rad};
}

/// The steps of one calibration; each step uses the results of the step before it.
class Calibrating {
 public:
  Calibrating(const Measurements& measurements, const CellMeans& means, const CalibrateOptions& options)
      : measurements_(measurements), means_(means), options_(options) {}

  Result<calibration::Calibration> run(std::string date) {
    calibration_.date = std::move(date);
    TRY_ASSIGN(const TurntableSolver solver, TurntableSolver::create(measurements_, means_, options_.turntable));
    TRY_ASSIGN(calibration_.turntable, solver.solve());
    samples_ = samples_of(measurements_, means_, calibration_.turntable);
    if (options_.previous != nullptr) use_previous_maps(solver);
    if (options_.with_wall) find_wall(solver);
    if (options_.previous != nullptr) turn_ = turn_of(*options_.previous, measurements_, samples_);
    std::vector<std::future<Result<calibration::MeasuredMap>>> maps;
    for (std::size_t p = 0; p < samples_.size(); ++p) {
      maps.push_back(std::async(std::launch::async, [this, p] {
        const MeasuredProjector& format = measurements_.projectors[p];
        return fit_measured_map(format.width_px, format.height_px, samples_[p], options_.map);
      }));
    }
    for (std::size_t p = 0; p < samples_.size(); ++p) TRY(add_projector(p, maps[p].get()));
    keep_maps_that_register_as_well();
    if (means_.refused * 20 > means_.used) {
      remark(fmt::format("{} of {} decoded pixels disagree with their neighbours; darken the room", means_.refused,
                         means_.used + means_.refused));
    }
    return std::move(calibration_);
  }

 private:
  void remark(std::string words) { calibration_.remarks.push_back(std::move(words)); }

  /// Solves the turntable again with the previous maps as hints, if the previous calibration determined the camera's
  /// offset better. The offset is observable only by parallax and may be lost in noise; all directions then share an
  /// error, and correct maps would seem wrong. Projectors that have been displaced since are outliers.
  void use_previous_maps(const TurntableSolver& solver) {
    const calibration::Calibration& before = *options_.previous;
    if (!(before.turntable.offset_sigma_m.norm() <= calibration_.turntable.offset_sigma_m.norm())) return;
    const Eigen::Matrix3d turn = turn_of(before, measurements_, samples_);
    TurntableHints hints;
    hints.known = [this, &before, turn](std::size_t p, const Eigen::Vector2d& pixel) -> std::optional<KnownDirection> {
      const calibration::CalibratedProjector* projector = projector_of(&before, measurements_.projectors[p].name);
      if (projector == nullptr) return std::nullopt;
      return known_direction(projector->map, turn, pixel);
    };
    auto turntable = solver.solve(hints);
    if (!turntable || !(turntable->heldout_rms_px <= kHintAgrees * calibration_.turntable.heldout_rms_px)) {
      remark(
          fmt::format("the maps of {} do not agree with the new directions ({:.3f} px instead of {:.3f}); look "
                      "whether the turntable was moved",
                      before.date, turntable ? turntable->heldout_rms_px : 0.0, calibration_.turntable.heldout_rms_px));
      return;
    }
    // The offset is not more accurate than the maps from which it was derived.
    const Eigen::Vector2d both =
        turntable->offset_sigma_m.array().square() + before.turntable.offset_sigma_m.array().square();
    turntable->offset_sigma_m = both.cwiseSqrt();
    take(*std::move(turntable));
    hints_.known = hints.known;
  }

  /// Fits the wall and solves the turntable again with it: a fitted wall describes inverse depths that spherical
  /// harmonics cannot (a corner), and thereby improves the camera's offset.
  void find_wall(const TurntableSolver& solver) {
    auto wall = choose_model(measurements_.projectors, wall_samples(samples_, options_.wall_samples),
                             measurements_.wall_distance_m, options_.model);
    if (!wall) {
      remark("the wall's shape was not found, so pictures are right at the sweet spot alone: " +
             wall.error().message());
      return;
    }
    TurntableHints hints = hints_;
    hints.wall = &wall->fit.surface;
    auto turntable = solver.solve(hints);
    if (turntable && turntable->wall &&
        turntable->heldout_rms_px <= kHintAgrees * calibration_.turntable.heldout_rms_px) {
      if (hints_.known) turntable->offset_sigma_m = calibration_.turntable.offset_sigma_m;
      take(*std::move(turntable));
      auto fit = fit_surface(measurements_.projectors, wall_samples(samples_, options_.wall_samples), wall->fit,
                             {wall->lens, true, kRefitSteps});
      if (fit) wall->fit = *std::move(fit);
    }
    calibration_.wall = *std::move(wall);
  }

  void take(calibration::CalibratedTurntable turntable) {
    calibration_.turntable = std::move(turntable);
    samples_ = samples_of(measurements_, means_, calibration_.turntable);
  }

  Status add_projector(std::size_t p, Result<calibration::MeasuredMap> map) {
    const MeasuredProjector& format = measurements_.projectors[p];
    if (!map) return std::move(map).error().while_doing(fmt::format("mapping projector '{}'", format.name));
    calibration::CalibratedProjector projector{format.name, *std::move(map), false};
    const calibration::CalibratedProjector* before = projector_of(options_.previous, format.name);
    if (before != nullptr && before->map.width_px == format.width_px && before->map.height_px == format.height_px) {
      calibration::MeasuredMap old = turned(before->map, turn_);
      const auto error = map_error_px(old, samples_[p]);
      const double own = projector.map.heldout_rms_px;
      // An old map with a hole that the new map does not have is replaced, however accurate the rest of it is.
      const bool has_hole = known_part(old, samples_[p]) < known_part(projector.map, samples_[p]) - kMaxUnknownShare;
      projector.is_previous = error && *error < kStillRight * own && !has_hole;
      if (projector.is_previous) projector.map = old;
      if (error && !has_hole) {
        maps_of_before_.emplace_back(p, old);
        worst_of_before_ = std::max(worst_of_before_, *error / std::max(own, 1e-9));
      }
      if (error) {
        remark(
            fmt::format("projector '{}' {} map of {}: it predicts the new measurements to {:.3f} px, the new one what "
                        "it left out to {:.3f}",
                        format.name, projector.is_previous ? "keeps its" : "needed another than its",
                        options_.previous->date, *error, own));
      }
    }
    if (projector.map.heldout_rms_px > kMaxUnremarkedError_px) {
      remark(
          fmt::format("projector '{}': places that were left out are predicted to {:.2f} px only; measure again in "
                      "the dark, with more pictures, and with nobody before the wall",
                      format.name, projector.map.heldout_rms_px));
    }
    calibration_.projectors.push_back(std::move(projector));
    return Done{};
  }

  /// Keeps all old maps if they register as well as the new ones: the new maps then differ only by the camera's error
  /// (few degrees seen, much noise), and no projector was displaced. Applies if some maps were kept and others not,
  /// since the two kinds must register with each other, and if none was kept but all were close to the limit.
  void keep_maps_that_register_as_well() {
    std::vector<calibration::CalibratedProjector>& projectors = calibration_.projectors;
    const auto kept = std::ranges::count_if(projectors, &calibration::CalibratedProjector::is_previous);
    const bool is_mixed = kept > 0 && static_cast<std::size_t>(kept) < projectors.size();
    const bool is_hardly_worse = kept == 0 && worst_of_before_ < kHardlyWorse;
    if (!(is_mixed || is_hardly_worse) || maps_of_before_.size() < projectors.size()) return;
    calibration::Calibration before = calibration_;
    for (auto& [p, map] : maps_of_before_) before.projectors[p].map = std::move(map);
    const MeasuredRegistration as_it_was = measured_registration(measurements_, before);
    const MeasuredRegistration anew = measured_registration(measurements_, calibration_);
    if (as_it_was.correspondences == 0 || as_it_was.mean_px > kRegistersAsWell * anew.mean_px) return;
    for (std::size_t p = 0; p < projectors.size(); ++p)
      projectors[p] = {projectors[p].name, std::move(before.projectors[p].map), true};
    remark(
        fmt::format("all projectors keep their maps of {}: those meet to {:.3f} px in the new measurements, the new "
                    "ones to {:.3f}",
                    options_.previous->date, as_it_was.mean_px, anew.mean_px));
  }

  const Measurements& measurements_;
  const CellMeans& means_;
  const CalibrateOptions& options_;
  calibration::Calibration calibration_;
  /// Old maps without holes, rotated to the new frame.
  std::vector<std::pair<std::size_t, calibration::MeasuredMap>> maps_of_before_;
  double worst_of_before_ = 0.0;  ///< Largest error of an old map relative to the new map's error on left-out samples.
  Samples samples_;
  TurntableHints hints_;
  Eigen::Matrix3d turn_ = Eigen::Matrix3d::Identity();  ///< Rotation from the previous calibration.
};

}  // namespace

Result<calibration::Calibration> calibrate(const Measurements& measurements, std::string date,
                                           const CalibrateOptions& options) {
  TRY(measurements.validate());
  const CellMeans means = average_cells(measurements, fitting_cell_px(measurements));
  return Calibrating(measurements, means, options).run(std::move(date));
}

calibration::MeasuredMap seen_from(const calibration::MeasuredMap& map, const calibration::Surface& wall,
                                   const Eigen::Vector3d& eye_m) {
  calibration::MeasuredMap moved = map;
  for (Eigen::Vector3d& direction : moved.directions) {
    if (!direction.allFinite()) continue;
    const auto inverse_depth = wall.inverse_depth_at(direction);
    // This is (direction / inverse_depth - eye) times the inverse depth, which may be 0.
    const Eigen::Vector3d seen = direction - inverse_depth.value_or(0.0) * eye_m;
    if (inverse_depth && seen.norm() > 1e-9) {
      direction = seen.normalized();
    } else {
      direction.setConstant(std::numeric_limits<double>::quiet_NaN());
    }
  }
  return moved;
}

}  // namespace cyclorama::solve
