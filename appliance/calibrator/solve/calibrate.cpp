// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibrator/solve/calibrate.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace cyclorama {
namespace {

constexpr double kWallFloor_px = 0.05;  // Of a sample's sigma: what lens models leave.
// A map that predicts new measurements as well as the new one predicts what it left out is still right; left-out
// errors of some hundred places scatter by some percent.
constexpr double kStillRight = 1.1;
constexpr double kWorthSaying_px = 0.5;  // Held-out error of a map.

const CalibratedProjector* projector_of(const Calibration* calibration, const std::string& name) {
  if (calibration == nullptr) return nullptr;
  const auto at = std::find_if(calibration->projectors.begin(), calibration->projectors.end(),
                               [&](const CalibratedProjector& p) { return p.name == name; });
  return at == calibration->projectors.end() ? nullptr : &*at;
}

/// What turns directions of the calibration before onto the new ones: the plate's heading and tilt are told anew each
/// time. Without what is farther off than most, since a projector may have been moved.
Eigen::Matrix3d turn_of(const Calibration& before, const Measurements& measurements,
                        const std::vector<std::vector<MapSample>>& samples) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> pairs;
  for (std::size_t p = 0; p < samples.size(); ++p) {
    const CalibratedProjector* projector = projector_of(&before, measurements.projectors[p].name);
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

MeasuredMap turned(const MeasuredMap& map, const Eigen::Matrix3d& turn) {
  MeasuredMap moved = map;
  for (Eigen::Vector3d& d : moved.directions) d = Eigen::Vector3d(turn * d);
  return moved;
}

/// Few, spread evenly over each projector's picture.
std::vector<SurfaceSample> wall_samples(const std::vector<std::vector<MapSample>>& samples, std::size_t count) {
  std::vector<SurfaceSample> chosen;
  const std::size_t each = std::max<std::size_t>(1, count / std::max<std::size_t>(1, samples.size()));
  for (std::size_t p = 0; p < samples.size(); ++p) {
    if (samples[p].empty()) continue;
    // A step that shares no factor with the rows' length scatters the samples.
    std::size_t step = std::max<std::size_t>(1, samples[p].size() / each);
    if (step > 1 && step % 2 == 0) ++step;
    for (std::size_t i = 0; i < samples[p].size(); i += step) {
      const MapSample& s = samples[p][i];
      chosen.push_back({p, s.projector_px, s.direction, std::hypot(s.sigma_px, kWallFloor_px)});
    }
  }
  return chosen;
}

}  // namespace

Result<Calibration> calibrate(const Measurements& measurements, std::string date, const CalibrateOptions& options) {
  TRY(measurements.validate());
  const CellMeans means = average_cells(measurements, fitting_cell_px(measurements));
  Calibration calibration;
  calibration.date = std::move(date);
  TRY_ASSIGN(calibration.plate, solve_turn_plate(measurements, means, options.plate));
  std::vector<std::vector<MapSample>> samples(measurements.projectors.size());
  for (const CellMean& cell : means.cells) {
    const auto d = calibration.plate.sight_of(static_cast<std::size_t>(cell.direction), cell.camera_px);
    if (d) samples[static_cast<std::size_t>(cell.projector)].push_back({cell.projector_px, *d, cell.sigma_px});
  }
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  if (options.previous != nullptr) turn = turn_of(*options.previous, measurements, samples);
  for (std::size_t p = 0; p < samples.size(); ++p) {
    const MeasuredProjector& format = measurements.projectors[p];
    auto map = fit_measured_map(format.width_px, format.height_px, samples[p], options.map);
    if (!map) return std::move(map).error().while_doing(fmt::format("mapping projector '{}'", format.name));
    CalibratedProjector projector{format.name, *std::move(map), false};
    const CalibratedProjector* before = projector_of(options.previous, format.name);
    if (before != nullptr && before->map.width_px == format.width_px && before->map.height_px == format.height_px) {
      const MeasuredMap old = turned(before->map, turn);
      const auto error = map_error_px(old, samples[p]);
      if (error && *error < kStillRight * projector.map.heldout_rms_px) {
        const double own = projector.map.heldout_rms_px;
        projector.map = old;
        projector.is_previous = true;
        calibration.remarks.push_back(
            fmt::format("projector '{}' keeps its map of {}: it predicts the new measurements to {:.3f} px, the new "
                        "one what it left out to {:.3f}",
                        format.name, options.previous->date, *error, own));
      }
    }
    if (projector.map.heldout_rms_px > kWorthSaying_px) {
      calibration.remarks.push_back(
          fmt::format("projector '{}': places that were left out are predicted to {:.2f} px only; measure again in the "
                      "dark, with more pictures, and with nobody before the wall",
                      format.name, projector.map.heldout_rms_px));
    }
    calibration.projectors.push_back(std::move(projector));
  }
  if (means.refused * 20 > means.used) {
    calibration.remarks.push_back(fmt::format("{} of {} decoded pixels disagree with their neighbours; darken the room",
                                              means.refused, means.used + means.refused));
  }
  if (!options.with_wall) return calibration;
  auto wall = choose_model(measurements.projectors, wall_samples(samples, options.wall_samples),
                           measurements.wall_distance_m, options.model);
  if (wall) {
    calibration.wall = *std::move(wall);
  } else {
    calibration.remarks.push_back("the wall's shape was not found, so pictures are right at the sweet spot alone: " +
                                  wall.error().message());
  }
  return calibration;
}

MeasuredMap seen_from(const MeasuredMap& map, const Surface& wall, const Eigen::Vector3d& eye_m) {
  MeasuredMap moved = map;
  for (Eigen::Vector3d& direction : moved.directions) {
    if (!direction.allFinite()) continue;
    const auto nearness = wall.nearness_at(direction);
    // direction / nearness - eye, times the nearness, which may be 0.
    const Eigen::Vector3d seen = direction - nearness.value_or(0.0) * eye_m;
    if (nearness && seen.norm() > 1e-9) {
      direction = seen.normalized();
    } else {
      direction.setConstant(std::numeric_limits<double>::quiet_NaN());
    }
  }
  return moved;
}

}  // namespace cyclorama
