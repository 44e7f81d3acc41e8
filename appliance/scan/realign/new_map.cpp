// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/realign/new_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "appliance/scan/realign/map_points.h"
#include "appliance/solve/cell_means.h"
#include "appliance/solve/map_fit.h"

namespace cyclorama::scan {
namespace {

constexpr std::size_t kMinCells = 60;
constexpr int kMinFitting_px = 8;
constexpr int kCellsAcross = 60;
constexpr double kMaxReferenceError_px = 1.0;  // A larger error means that a reference projector was displaced, too.
// The old map is kept if its error on left-out cells is at most this multiple of the new map's error.
constexpr double kStillRight = 1.1;
constexpr double kStillRightFloor_px = 0.1;  // At a width of 1920 pixels; smaller errors are invisible.
constexpr double kMinSeen = 0.4;             // Minimum fraction of the old map that must be seen.
constexpr unsigned kBlock_px = 64;           // Blocks are left out, since a smooth map bridges single cells.
constexpr unsigned kLeftOutEvery = 6;
constexpr int kFill_px = 32;
constexpr double kFillFloor_px = 0.4;  // Sigma of directions that follow from the displacement alone.

/// Returns true for one block of pixels in kLeftOutEvery, scattered by a fixed hash.
bool is_left_out(const Eigen::Vector2d& pixel) {
  const auto column = static_cast<unsigned>(std::max(0.0, pixel.x())) / kBlock_px;
  const auto row = static_cast<unsigned>(std::max(0.0, pixel.y())) / kBlock_px;
  const unsigned hash = (column * 2654435761U) ^ (row * 2246822519U);
  return (hash >> 9) % kLeftOutEvery == 0;
}

std::size_t points_of(const calibration::MeasuredMap& map) {
  std::size_t count = 0;
  for_points(map, [&](const Eigen::Vector2d&, const Eigen::Vector3d&) { ++count; });
  return count;
}

Result<calibration::MeasuredMap> fit_map(const calibration::CalibratedProjector& projector,
                                         std::span<const solve::MapSample> samples) {
  auto map = solve::fit_measured_map(projector.map.width_px, projector.map.height_px, samples);
  if (!map) return std::move(map).error().while_doing(fmt::format("mapping projector '{}'", projector.name));
  return map;
}

/// Returns measurements of a single direction of the turntable. Projector 0 is the displaced one; the reference
/// projectors follow in their order.
solve::Measurements measurements_of(const RealignmentBaseline& baseline, const RealignmentPhotographs& photographs) {
  solve::Measurements all;
  const calibration::CalibratedProjector& target = baseline.projector();
  all.camera = baseline.calibration.turntable.camera;
  all.projectors.push_back({target.name, target.map.width_px, target.map.height_px, {}});
  for (std::size_t r = 0; r < baseline.references.size(); ++r) {
    const ReferenceProjector& reference = baseline.references[r];
    const calibration::CalibratedProjector& calibrated =
        baseline.calibration.projectors[baseline.reference_maps[r].calibrated];
    all.projectors.push_back({calibrated.name, reference.width_px, reference.height_px, {}});
  }
  auto& places = all.directions.emplace_back().correspondences;
  for (solve::Correspondence position : photographs.target.correspondences) {
    position.projector = 0;
    places.push_back(position);
  }
  for (solve::Correspondence position : photographs.references.correspondences) {
    ++position.projector;
    places.push_back(position);
  }
  return all;
}

/// Averages correspondences of the displaced projector or of the references over cells. The two cell sizes differ,
/// since references may be decoded at only one in four camera pixels.
solve::CellMeans cells_of(const solve::Measurements& all, bool of_target) {
  solve::Measurements some = all;
  auto& places = some.directions[0].correspondences;
  std::erase_if(places, [&](const solve::Correspondence& position) { return (position.projector == 0) != of_target; });
  int cell_px = solve::fitting_cell_px(some);
  // A very small, densely seen picture would give too few cells.
  if (cell_px == kMinFitting_px) cell_px = std::clamp(some.projectors[0].width_px / kCellsAcross, 2, cell_px);
  return solve::average_cells(some, cell_px);
}

Result<LocatedCamera> camera_by_references(const RealignmentBaseline& baseline, const LocatedCamera& planned,
                                           const solve::CellMeans& means) {
  std::vector<ReferenceObservation> observations;
  double scale_rad = 0.0;
  for (const solve::CellMean& cell : means.cells) {
    const std::size_t p = baseline.reference_maps[static_cast<std::size_t>(cell.projector) - 1].calibrated;
    const calibration::MeasuredMap& map = baseline.calibration.projectors[p].map;
    const auto ray = calibration::direction_through(baseline.lens, cell.camera_px);
    const auto d = map.direction_at(cell.projector_px);
    const auto beside = map.direction_at(cell.projector_px + Eigen::Vector2d(1.0, 0.0));
    if (!ray || !d || !beside) continue;
    const double pixel_rad = (*beside - *d).norm();
    if (!(pixel_rad > 0.0)) continue;
    const double sigma_px = std::hypot(std::hypot(cell.sigma_px, map.sigma_at(cell.projector_px)), 0.05);
    observations.push_back({ray->normalized(), *d, baseline.camera_inverse_depth(*d), sigma_px * pixel_rad,
                            is_left_out(cell.projector_px)});
    scale_rad += pixel_rad;
  }
  auto camera = locate_camera(planned, observations);
  if (!camera) return realignment_refused(camera.error().message());
  const double off_px = camera->heldout_rad / (scale_rad / static_cast<double>(observations.size()));
  if (!(off_px < kMaxReferenceError_px)) {
    return realignment_refused(
        fmt::format("the other projectors are {:.1f} px from where they were calibrated: another one was "
                    "moved too, or the camera stands elsewhere",
                    off_px));
  }
  return camera;
}

/// Returns the directions in which the sweet spot sees the displaced projector's cells.
std::vector<solve::MapSample> samples_of(const RealignmentBaseline& baseline, const LocatedCamera& camera,
                                         const solve::CellMeans& means) {
  const InverseDepthAt inverse_depth = [&](const Eigen::Vector3d& d) { return baseline.camera_inverse_depth(d); };
  std::vector<solve::MapSample> samples;
  for (const solve::CellMean& cell : means.cells) {
    const auto ray = calibration::direction_through(baseline.lens, cell.camera_px);
    if (!ray) continue;
    const auto d = wall_direction_from(camera.centre_m, camera.R_camera_eye.transpose() * *ray, inverse_depth);
    if (d) samples.push_back({cell.projector_px, *d, cell.sigma_px});
  }
  return samples;
}

/// Returns the displacement that explains the samples. Errors: kBadData if the lens was turned or no displacement
/// explains them.
Result<Displacement> displacement_of(const RealignmentBaseline& baseline, std::span<const solve::MapSample> samples) {
  const calibration::CalibratedProjector& target = baseline.projector();
  const InverseDepthAt inverse_depth = [&](const Eigen::Vector3d& d) { return baseline.wall_inverse_depth(d); };
  const auto found =
      find_displacement(baseline.calibration.wall->fit.projectors[baseline.target], target.map, samples, inverse_depth);
  if (!found) return realignment_refused(fmt::format("where projector '{}' stands now was not found", target.name));
  if (found->verdict == DisplacementVerdict::kLensTurned) {
    return realignment_refused(
        fmt::format("the lens of projector '{}' was turned (zoom by {:+.1f} %, shift by {:.0f}, {:.0f} px)",
                    target.name, 100.0 * (found->zoom - 1.0), found->shift_px.x(), found->shift_px.y()));
  }
  if (found->verdict == DisplacementVerdict::kUnexplained) {
    return realignment_refused(
        fmt::format("what projector '{}' lights is {:.1f} px from what a displacement explains: look whether "
                    "something stands in its light",
                    target.name, found->after_px));
  }
  return *found;
}

struct FilledMap {
  calibration::MeasuredMap map;
  double seen_fraction = 1.0;
};

/// Adds the unseen part of the picture, computed from the wall and the displacement; otherwise the map would lose its
/// rim.
Result<FilledMap> filled(const RealignmentBaseline& baseline, const Displacement& displacement,
                         std::span<const solve::MapSample> samples, const calibration::MeasuredMap& map) {
  const calibration::CalibratedProjector& target = baseline.projector();
  const calibration::MeasuredMap& old = target.map;
  const int columns = old.width_px / kFill_px + 1;
  const int rows = old.height_px / kFill_px + 1;
  std::vector<char> is_seen(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0);
  const auto at = [&](const Eigen::Vector2d& pixel) {
    const int x = std::clamp(static_cast<int>(pixel.x()) / kFill_px, 0, columns - 1);
    const int y = std::clamp(static_cast<int>(pixel.y()) / kFill_px, 0, rows - 1);
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(x);
  };
  for (const solve::MapSample& sample : samples) is_seen[at(sample.projector_px)] = 1;
  const InverseDepthAt inverse_depth = [&](const Eigen::Vector3d& d) { return baseline.wall_inverse_depth(d); };
  TRY_ASSIGN(const calibration::BrownLens lens, displacement.projector.lens.brown());
  std::size_t missing = 0;
  std::size_t all = 0;
  std::vector<solve::MapSample> more;
  for_points(old, [&](const Eigen::Vector2d& pixel, const Eigen::Vector3d&) {
    ++all;
    if (map.direction_at(pixel)) return;
    ++missing;
    if (is_seen[at(pixel)] != 0) return;
    const auto d = drawn_direction(displacement.projector, lens, pixel, inverse_depth);
    if (d) more.push_back({pixel, *d, std::hypot(displacement.after_px, kFillFloor_px)});
  });
  const double seen =
      std::min(1.0, 1.0 - static_cast<double>(missing) / static_cast<double>(std::max<std::size_t>(1, all)));
  if (seen < kMinSeen || points_of(map) == 0) {
    return realignment_refused(
        fmt::format("the camera sees {:.0f} % of what projector '{}' lights", 100.0 * seen, target.name));
  }
  if (more.empty()) return FilledMap{map, seen};
  more.insert(more.begin(), samples.begin(), samples.end());
  TRY_ASSIGN(calibration::MeasuredMap whole, fit_map(target, more));
  whole.heldout_rms_px = map.heldout_rms_px;
  return FilledMap{std::move(whole), seen};
}

/// Measures the registration over correspondences that no map of the displaced projector was fitted to.
solve::MeasuredRegistration registration_with(const RealignmentBaseline& baseline, const solve::Measurements& all,
                                              const calibration::MeasuredMap& map) {
  solve::Measurements held = all;
  std::erase_if(held.directions[0].correspondences, [](const solve::Correspondence& position) {
    return position.projector == 0 &&
           !is_left_out({static_cast<double>(position.projector_x), static_cast<double>(position.projector_y)});
  });
  calibration::Calibration some;
  some.projectors.push_back({baseline.projector().name, map});
  for (const ReferenceMap& reference : baseline.reference_maps)
    some.projectors.push_back(baseline.calibration.projectors[reference.calibrated]);
  return solve::measured_registration(held, some);
}

}  // namespace

Result<NewMap> find_new_map(const RealignmentBaseline& baseline, const RealignmentPhotographs& photographs) {
  const calibration::CalibratedProjector& target = baseline.projector();
  const solve::Measurements all = measurements_of(baseline, photographs);
  TRY(all.validate());
  TRY_ASSIGN(const LocatedCamera camera, camera_by_references(baseline, photographs.planned, cells_of(all, false)));
  const std::vector<solve::MapSample> samples = samples_of(baseline, camera, cells_of(all, true));
  if (samples.size() < kMinCells) {
    return realignment_refused(
        fmt::format("the camera sees too little of projector '{}': {} places", target.name, samples.size()));
  }
  NewMap found;
  if (camera.is_elsewhere) found.camera_moved_m = (camera.centre_m - photographs.planned.centre_m).norm();
  found.before = registration_with(baseline, all, target.map);

  std::vector<solve::MapSample> known;
  std::vector<solve::MapSample> left_out;
  for (const solve::MapSample& sample : samples)
    (is_left_out(sample.projector_px) ? left_out : known).push_back(sample);
  const auto old_error = solve::map_error_px(target.map, left_out);
  TRY_ASSIGN(const calibration::MeasuredMap trial, fit_map(target, known));
  const auto new_error = solve::map_error_px(trial, left_out);
  if (!new_error)
    return realignment_refused(fmt::format("what is seen of projector '{}' has too many gaps", target.name));
  const double still_right_px = std::max(kStillRight * *new_error, kStillRightFloor_px * target.map.width_px / 1920.0);
  if (old_error && *old_error <= still_right_px) {
    found.old_error_px = *old_error;
    return found;
  }
  TRY_ASSIGN(const Displacement displacement, displacement_of(baseline, samples));
  TRY_ASSIGN(const FilledMap whole_trial, filled(baseline, displacement, known, trial));
  const solve::MeasuredRegistration after = registration_with(baseline, all, whole_trial.map);
  if (after.correspondences < kMinCells)
    return realignment_refused(fmt::format("projector '{}' meets no other one any more; turn it back", target.name));
  const bool is_better = (!old_error || *new_error < *old_error) &&
                         (found.before.correspondences < kMinCells || after.p95_px < found.before.p95_px);
  if (!is_better) {
    return realignment_refused(
        fmt::format("a new map of projector '{}' would be no better ({:.2f} px instead of {:.2f})", target.name,
                    after.p95_px, found.before.p95_px));
  }
  TRY_ASSIGN(const calibration::MeasuredMap map, fit_map(target, samples));
  TRY_ASSIGN(FilledMap whole, filled(baseline, displacement, samples, map));
  whole.map.heldout_rms_px = *new_error;
  found.displaced = DisplacedMap{std::move(whole.map), displacement, after, whole.seen_fraction};
  return found;
}

}  // namespace cyclorama::scan
