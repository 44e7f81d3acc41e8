// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/realign/realignment.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "appliance/calibration/calibration_file.h"
#include "appliance/photometry/followed_light.h"
#include "appliance/photometry/light_file.h"
#include "appliance/scan/realign/camera_pose.h"
#include "appliance/scan/realign/projector_displacement.h"
#include "appliance/scan/realign/reference_view.h"
#include "appliance/scan/report_page.h"

namespace cyclorama {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr const char* kAll = "; calibrate all projectors";
// Finer bits cost pictures, and cells of many pixels need none: docs/design/calibration.md.
constexpr int kFinestBit = 2;
constexpr int kHeadings = 15;  // Either side of where it points,
constexpr double kHeadingStep_rad = 1.0 * kDegree;
constexpr double kTargetRim = 0.08;  // Of the camera's picture: a pushed picture is not quite where it was.
constexpr double kWitnessRim = 0.02;
constexpr double kWitnessWorth = 0.3;  // Of a direction, against one of the pushed projector's.
constexpr int kManyPixels = 1000;      // Of the camera's picture across: then every other is enough for witnesses.
constexpr double kInside = 1.0 / 240;  // So far inside of a witness's picture, in widths.
constexpr std::size_t kLeastCells = 60;
constexpr int kLeastFitting_px = 8;
constexpr int kCellsAcross = 60;
constexpr double kWorstWitness_px = 1.0;  // A witness that moved does not fit so well.
// A map that predicts what is seen now as well as a new one predicts what it left out is still right.
constexpr double kStillRight = 1.1;
constexpr double kStandsFloor_px = 0.1;  // Nobody sees less.
constexpr double kLeastSeen = 0.4;       // Of the map of before.
constexpr unsigned kBlock_px = 64;       // Whole blocks are left out: smoothness bridges less.
constexpr unsigned kLeftOutEvery = 6;
constexpr int kFill_px = 32;
constexpr double kFillFloor_px = 0.4;  // Sigma of what only the push tells.
constexpr const char* kRemark = "was measured anew alone: ";

Error refused(const std::string& what) { return Error(ErrorCode::kBadData, what + kAll); }

/// A fixed hash scatters the blocks.
bool is_left_out(const Eigen::Vector2d& pixel) {
  const auto column = static_cast<unsigned>(std::max(0.0, pixel.x())) / kBlock_px;
  const auto row = static_cast<unsigned>(std::max(0.0, pixel.y())) / kBlock_px;
  const unsigned hash = (column * 2654435761U) ^ (row * 2246822519U);
  return (hash >> 9) % kLeftOutEvery == 0;
}

template <typename Body>
void for_points(const MeasuredMap& map, const Body& body) {
  for (int y = 0; y <= map.cells_y; ++y) {
    for (int x = 0; x <= map.cells_x; ++x) {
      const auto at =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(map.cells_x + 1) + static_cast<std::size_t>(x);
      const Eigen::Vector2d pixel(x * static_cast<double>(map.width_px) / map.cells_x,
                                  y * static_cast<double>(map.height_px) / map.cells_y);
      if (map.directions[at].allFinite()) body(pixel, map.directions[at]);
    }
  }
}

std::size_t points_of(const MeasuredMap& map) {
  std::size_t count = 0;
  for_points(map, [&](const Eigen::Vector2d&, const Eigen::Vector3d&) { ++count; });
  return count;
}

class Realigning {
 public:
  Realigning(const Installation& installation, const ScanSettings& settings, const ScanDevices& devices,
             const ScanListener& listener, std::stop_token stop)
      : installation_(installation),
        settings_(settings),
        devices_(devices),
        listener_(listener),
        stop_(std::move(stop)) {}

  Result<RealignmentOutcome> run(const std::string& projector, const std::filesystem::path& folder,
                                 const std::string& date, const Clock& clock) {
    TimePoint begun = clock.now();
    TRY(take_before(projector, folder));
    TRY(look());
    result_.outcome.scan_s = to_seconds(clock.now() - begun);
    tell("finds out where it stands now", 0.85);
    begun = clock.now();
    TRY(find_out());
    if (result_.has_moved) TRY(follow_with_colours(folder));
    result_.outcome.solve_s = to_seconds(clock.now() - begun);
    if (stop_.stop_requested()) return cancelled();
    if (result_.has_moved) TRY(write(folder, date));
    tell(result_.has_moved ? "is calibrated" : "stands where it stood", 1.0);
    return std::move(result_);
  }

 private:
  void tell(const std::string& step, double fraction) const {
    if (listener_) listener_({step, fraction, nullptr});
  }
  [[nodiscard]] Calibration& calibration() { return result_.outcome.calibration; }
  [[nodiscard]] const CalibratedProjector& target() const { return result_.outcome.calibration.projectors[target_]; }

  [[nodiscard]] std::optional<std::size_t> installed(const std::string& name) const {
    const auto& all = installation_.projectors;
    const auto at = std::find_if(all.begin(), all.end(), [&](const auto& p) { return p.name == name; });
    if (at == all.end()) return std::nullopt;
    return static_cast<std::size_t>(at - all.begin());
  }

  Status take_before(const std::string& projector, const std::filesystem::path& folder) {
    auto before = read_calibration(folder);
    if (!before) {
      const std::string why = before.error().message();
      if (before.error().code() == ErrorCode::kNotFound)
        return Error(ErrorCode::kNotFound, fmt::format("there is no calibration of before ({}){}", why, kAll));
      return std::move(before).error().while_doing("looking for the calibration of before");
    }
    before_ = *std::move(before);
    calibration() = before_;
    const auto& all = before_.projectors;
    const auto at = std::find_if(all.begin(), all.end(), [&](const auto& p) { return p.name == projector; });
    const auto number = installed(projector);
    if (at == all.end() || !number) {
      return Error(ErrorCode::kNotFound, fmt::format("no projector '{}' was calibrated before{}", projector, kAll));
    }
    target_ = static_cast<std::size_t>(at - all.begin());
    target_installed_ = *number;
    const MeasuredLens& camera = before_.plate.camera;
    if (camera.width_px != devices_.camera.width_px() || camera.height_px != devices_.camera.height_px())
      return refused("the calibration of before was made with another camera");
    if (!before_.wall) return refused("the calibration of before does not know the wall's shape");
    TRY_ASSIGN(BrownLens lens, camera.brown());
    lens_ = std::move(lens);
    for (std::size_t p = 0; p < all.size(); ++p) {
      const auto witness = installed(all[p].name);
      if (p == target_ || !witness) continue;
      const Pinhole& format = installation_.projectors[*witness].lens;
      if (format.width_px != all[p].map.width_px || format.height_px != all[p].map.height_px) continue;
      auto inverse = InverseMap::make(all[p].map);
      if (!inverse) continue;
      witnesses_.push_back({*witness, format.width_px, format.height_px});
      witness_maps_.push_back(p);
      inverses_.push_back(*std::move(inverse));
    }
    if (witnesses_.empty())
      return refused(fmt::format("projector '{}' has no neighbour that tells how the camera stands", projector));
    const Pinhole& format = installation_.projectors[target_installed_].lens;
    if (format.width_px != target().map.width_px || format.height_px != target().map.height_px)
      return refused(fmt::format("projector '{}' has another number of pixels than before", projector));
    return Done{};
  }

  [[nodiscard]] double camera_nearness(const Eigen::Vector3d& d) const {
    const TurnPlate& plate = before_.plate;
    return NearnessField{plate.nearness, plate.wall ? &*plate.wall : nullptr}.at(d);
  }
  [[nodiscard]] double wall_nearness(const Eigen::Vector3d& d) const {
    return before_.wall->fit.surface.nearness_at(d).value_or(-1.0);
  }

  [[nodiscard]] bool is_in_view(const CameraStand& stand, const Eigen::Vector3d& d, double rim) const {
    const auto pixel = lens_->pixel_of(stand.R_camera_eye * (d - camera_nearness(d) * stand.centre_m));
    if (!pixel) return false;
    const double u = pixel->x() / before_.plate.camera.width_px;
    const double v = pixel->y() / before_.plate.camera.height_px;
    return u >= rim && u <= 1.0 - rim && v >= rim && v <= 1.0 - rim;
  }

  /// Where it sees all of the pushed projector's light, and as much as can be of the others'.
  [[nodiscard]] double best_angle() const {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for_points(target().map, [&](const Eigen::Vector2d&, const Eigen::Vector3d& d) { middle += d; });
    const double towards = std::atan2(middle.x(), -middle.z());
    const TurnRange range = devices_.plate.range();
    double best = std::clamp(towards, range.least_rad, range.most_rad);
    double best_worth = -1.0;
    for (int i = -kHeadings; i <= kHeadings; ++i) {
      const double angle = std::remainder(towards + i * kHeadingStep_rad, 2.0 * std::numbers::pi);
      if (angle < range.least_rad || angle > range.most_rad) continue;
      const CameraStand stand = planned_stand(before_.plate, angle);
      double worth = -1e-3 * std::abs(i);  // Straight at it, where nothing else matters.
      int n = 0;
      for (std::size_t p = 0; p < before_.projectors.size(); ++p) {
        for_points(before_.projectors[p].map, [&](const Eigen::Vector2d&, const Eigen::Vector3d& d) {
          if (n++ % 5 != 0) return;
          if (is_in_view(stand, d, p == target_ ? kTargetRim : kWitnessRim))
            worth += p == target_ ? 1.0 : kWitnessWorth;
        });
      }
      if (worth > best_worth) {
        best_worth = worth;
        best = angle;
      }
    }
    return best;
  }

  Status look() {
    const double angle = best_angle();
    tell(fmt::format("turns the camera to {:.0f} degrees", angle / kDegree), 0.0);
    TRY(turn_plate(devices_.plate, angle));
    for (std::size_t p = 0; p < installation_.projectors.size(); ++p) TRY(devices_.screen.show(p, RgbImage()));
    planned_ = planned_stand(before_.plate, angle);
    TRY_ASSIGN(target_view_, target_view());
    outcome().pictures += target_view_.pictures;
    if (!(target_view_.exposure_s > 0.0) || target_view_.places.empty()) {
      return Error(ErrorCode::kUnavailable,
                   fmt::format("the camera sees no light of projector '{}': switch it on, take its cover off, or turn "
                               "it back towards the wall",
                               target().name));
    }
    const PhotographListener photographed = [&](const std::string& picture, double fraction,
                                                const ScanPhotograph& photograph) {
      if (listener_) listener_({"looks at the other projectors: " + picture, 0.65 + 0.2 * fraction, &photograph});
    };
    TRY_ASSIGN(witness_view_,
               measure_witnesses(witnesses_, expectation(), target_view_.exposure_s, settings_.view.exposure,
                                 devices_.screen, devices_.camera, photographed, stop_));
    outcome().pictures += witness_view_.pictures;
    return Done{};
  }

  /// Once more, when somebody was in the way; the better one counts.
  Result<ScanView> target_view() {
    const PhotographListener photographed = [&](const std::string& picture, double fraction,
                                                const ScanPhotograph& photograph) {
      if (listener_) {
        listener_(
            {fmt::format("measures projector '{}': {}", target().name, picture), 0.05 + 0.6 * fraction, &photograph});
      }
    };
    ViewSettings settings = settings_.view;
    settings.finest_bit = std::max(settings.finest_bit, kFinestBit);
    settings.phase_period_px = 0.0;
    settings.phase_steps = 0;
    if (settings.base_bit >= 0) settings.base_bit = std::max(settings.base_bit, settings.finest_bit);
    const ViewOrder order{target_installed_, target().name, target().map.width_px, target().map.height_px, {}};
    TRY_ASSIGN(ScanView view, measure_view(order, settings, devices_.screen, devices_.camera, photographed, stop_));
    if (view.disturbed <= settings_.most_disturbed) return view;
    // The bar may not fall.
    const PhotographListener again = [&](const std::string& picture, double, const ScanPhotograph& photograph) {
      if (listener_)
        listener_({fmt::format("measures projector '{}' once more: {}", target().name, picture), 0.65, &photograph});
    };
    TRY_ASSIGN(ScanView second, measure_view(order, settings, devices_.screen, devices_.camera, again, stop_));
    ++outcome().retries;
    second.pictures += view.pictures;
    view.pictures = second.pictures;
    ScanView& better = second.disturbed < view.disturbed ? second : view;
    if (better.disturbed > settings_.most_disturbed) {
      calibration().remarks.push_back(
          fmt::format("projector '{}': something moved before {:.0f} % of its light; keep visitors away", target().name,
                      100.0 * better.disturbed));
    }
    return std::move(better);
  }

  [[nodiscard]] CalibrationOutcome& outcome() { return result_.outcome; }

  [[nodiscard]] WitnessExpectation expectation() const {
    const int width = before_.plate.camera.width_px;
    const int height = before_.plate.camera.height_px;
    WitnessExpectation expected{Image<float, 2>(width, height), Image<std::int16_t, 1>(width, height, -1)};
    const NearnessAt nearness = [this](const Eigen::Vector3d& d) { return camera_nearness(d); };
    const int every = width > kManyPixels ? 2 : 1;
    for (int y = 0; y < height; y += every) {
      for (int x = 0; x < width; x += every) {
        const auto ray = direction_through(*lens_, {x + 0.5, y + 0.5});
        if (!ray) continue;
        const auto d = seen_end(planned_.centre_m, planned_.R_camera_eye.transpose() * *ray, nearness);
        if (!d) continue;
        int sees = 0;
        for (std::size_t w = 0; w < witnesses_.size(); ++w) {
          const auto place = inverses_[w].pixel_at(*d);
          if (!place) continue;
          ++sees;
          const double rim = std::max(2.0, kInside * witnesses_[w].width_px);
          const bool is_inside = place->x() > rim && place->x() < witnesses_[w].width_px - rim && place->y() > rim &&
                                 place->y() < witnesses_[w].height_px - rim;
          if (!is_inside) ++sees;
          expected.place_px.at(x, y)[0] = static_cast<float>(place->x());
          expected.place_px.at(x, y)[1] = static_cast<float>(place->y());
          *expected.witness.at(x, y) = static_cast<std::int16_t>(w);
        }
        if (sees != 1) *expected.witness.at(x, y) = -1;
      }
    }
    return expected;
  }

  /// Of one direction; projector 0 is the pushed one, the others are the witnesses in their order.
  [[nodiscard]] Measurements measurements() const {
    Measurements all;
    all.camera = before_.plate.camera;
    all.projectors.push_back({target().name, target().map.width_px, target().map.height_px, {}});
    for (std::size_t w = 0; w < witnesses_.size(); ++w) {
      all.projectors.push_back(
          {before_.projectors[witness_maps_[w]].name, witnesses_[w].width_px, witnesses_[w].height_px, {}});
    }
    auto& places = all.directions.emplace_back().correspondences;
    for (Correspondence place : target_view_.places) {
      place.projector = 0;
      places.push_back(place);
    }
    for (Correspondence place : witness_view_.places) {
      ++place.projector;
      places.push_back(place);
    }
    return all;
  }

  /// Cells of each kind have their own size: witnesses are looked at in every fourth pixel only.
  [[nodiscard]] static CellMeans cells_of(const Measurements& all, bool of_target) {
    Measurements some = all;
    auto& places = some.directions[0].correspondences;
    std::erase_if(places, [&](const Correspondence& place) { return (place.projector == 0) != of_target; });
    int cell_px = fitting_cell_px(some);
    // Of a very small picture that is seen densely there would be too few.
    if (cell_px == kLeastFitting_px) cell_px = std::clamp(some.projectors[0].width_px / kCellsAcross, 2, cell_px);
    return average_cells(some, cell_px);
  }

  Status find_out() {
    const Measurements all = measurements();
    TRY(all.validate());
    TRY(stand(cells_of(all, false)));
    take_samples(cells_of(all, true));
    if (samples_.size() < kLeastCells) {
      return refused(
          fmt::format("the camera sees too little of projector '{}': {} places", target().name, samples_.size()));
    }
    std::vector<MapSample> known;
    std::vector<MapSample> left_out;
    for (const MapSample& sample : samples_) (is_left_out(sample.projector_px) ? left_out : known).push_back(sample);
    const auto old_error = map_error_px(target().map, left_out);
    auto trial = fit_measured_map(target().map.width_px, target().map.height_px, known);
    if (!trial) return std::move(trial).error().while_doing(fmt::format("mapping projector '{}'", target().name));
    const auto new_error = map_error_px(*trial, left_out);
    if (!new_error) return refused(fmt::format("what is seen of projector '{}' has too many gaps", target().name));
    const double stands_px = std::max(kStillRight * *new_error, kStandsFloor_px * target().map.width_px / 1920.0);
    if (old_error && *old_error <= stands_px) {
      result_.before = registration_with(all, target().map);
      outcome().registration = result_.before;
      calibration().remarks.push_back(fmt::format(
          "projector '{}' stands where it stood, within {:.2f} px: nothing was changed", target().name, *old_error));
      return Done{};
    }
    TRY(explain());
    TRY(fill(known, &*trial));
    const MeasuredRegistration after = registration_with(all, *trial);
    result_.before = registration_with(all, target().map);
    outcome().registration = after;
    if (after.places < kLeastCells)
      return refused(fmt::format("projector '{}' meets no other one any more; turn it back", target().name));
    const bool is_better = (!old_error || *new_error < *old_error) &&
                           (result_.before.places < kLeastCells || after.p95_px < result_.before.p95_px);
    if (!is_better) {
      return refused(fmt::format("a new map of projector '{}' would be no better ({:.2f} px instead of {:.2f})",
                                 target().name, after.p95_px, result_.before.p95_px));
    }
    auto map = fit_measured_map(target().map.width_px, target().map.height_px, samples_);
    if (!map) return std::move(map).error().while_doing(fmt::format("mapping projector '{}'", target().name));
    TRY(fill(samples_, &*map));
    map->heldout_rms_px = *new_error;
    for (CalibratedProjector& p : calibration().projectors) p.is_previous = true;
    CalibratedProjector& moved = calibration().projectors[target_];
    moved.map = *std::move(map);
    moved.is_previous = false;
    result_.has_moved = true;
    return Done{};
  }

  Status stand(const CellMeans& means) {
    std::vector<WitnessSight> sights;
    double scale_rad = 0.0;
    for (const CellMean& cell : means.cells) {
      const std::size_t p = witness_maps_[static_cast<std::size_t>(cell.projector) - 1];
      const MeasuredMap& map = before_.projectors[p].map;
      const auto ray = direction_through(*lens_, cell.camera_px);
      const auto d = map.direction_at(cell.projector_px);
      const auto beside = map.direction_at(cell.projector_px + Eigen::Vector2d(1.0, 0.0));
      if (!ray || !d || !beside) continue;
      const double pixel_rad = (*beside - *d).norm();
      if (!(pixel_rad > 0.0)) continue;
      const double sigma_px = std::hypot(std::hypot(cell.sigma_px, map.sigma_at(cell.projector_px)), 0.05);
      sights.push_back(
          {ray->normalized(), *d, camera_nearness(*d), sigma_px * pixel_rad, is_left_out(cell.projector_px)});
      scale_rad += pixel_rad;
    }
    auto found = find_stand(planned_, sights);
    if (!found) return refused(found.error().message());
    stand_ = *found;
    const double off_px = stand_.heldout_rad / (scale_rad / static_cast<double>(sights.size()));
    if (!(off_px < kWorstWitness_px)) {
      return refused(
          fmt::format("the other projectors are {:.1f} px from where they were calibrated: another one was "
                      "moved too, or the camera stands elsewhere",
                      off_px));
    }
    if (stand_.is_elsewhere) result_.camera_moved_m = (stand_.centre_m - planned_.centre_m).norm();
    return Done{};
  }

  void take_samples(const CellMeans& means) {
    const NearnessAt nearness = [this](const Eigen::Vector3d& d) { return camera_nearness(d); };
    for (const CellMean& cell : means.cells) {
      const auto ray = direction_through(*lens_, cell.camera_px);
      if (!ray) continue;
      const auto d = seen_end(stand_.centre_m, stand_.R_camera_eye.transpose() * *ray, nearness);
      if (d) samples_.push_back({cell.projector_px, *d, cell.sigma_px});
    }
  }

  Status explain() {
    const NearnessAt nearness = [this](const Eigen::Vector3d& d) { return wall_nearness(d); };
    const auto push = find_push(before_.wall->fit.projectors[target_], target().map, samples_, nearness);
    if (!push) return refused(fmt::format("where projector '{}' stands now was not found", target().name));
    push_ = *push;
    result_.turned_rad = push->turned_rad;
    result_.moved_m = push->moved_m;
    result_.explained_px = push->after_px;
    if (push->verdict == PushVerdict::kLensTurned) {
      return refused(
          fmt::format("the lens of projector '{}' was turned (zoom by {:+.1f} %, shift by {:.0f}, {:.0f} px)",
                      target().name, 100.0 * (push->zoom - 1.0), push->shift_px.x(), push->shift_px.y()));
    }
    if (push->verdict == PushVerdict::kUnexplained) {
      return refused(
          fmt::format("what projector '{}' lights is {:.1f} px from what a push explains: look whether "
                      "something stands in its light",
                      target().name, push->after_px));
    }
    calibration().wall->fit.projectors[target_] = push->projector;
    return Done{};
  }

  /// What the camera does not see of its picture follows from wall and push: without it a map would lose its rim.
  Status fill(std::vector<MapSample> samples, MeasuredMap* map) {
    const MeasuredMap& old = target().map;
    const int columns = old.width_px / kFill_px + 1;
    const int rows = old.height_px / kFill_px + 1;
    std::vector<char> is_seen(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0);
    const auto at = [&](const Eigen::Vector2d& pixel) {
      const int x = std::clamp(static_cast<int>(pixel.x()) / kFill_px, 0, columns - 1);
      const int y = std::clamp(static_cast<int>(pixel.y()) / kFill_px, 0, rows - 1);
      return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(x);
    };
    for (const MapSample& sample : samples) is_seen[at(sample.projector_px)] = 1;
    const auto measured = static_cast<double>(points_of(*map));
    const NearnessAt nearness = [this](const Eigen::Vector3d& d) { return wall_nearness(d); };
    TRY_ASSIGN(const BrownLens lens, push_->projector.lens.brown());
    std::size_t missing = 0;
    std::size_t all = 0;
    std::vector<MapSample> more;
    for_points(old, [&](const Eigen::Vector2d& pixel, const Eigen::Vector3d&) {
      ++all;
      if (map->direction_at(pixel)) return;
      ++missing;
      if (is_seen[at(pixel)] != 0) return;
      const auto d = drawn_direction(push_->projector, lens, pixel, nearness);
      if (d) more.push_back({pixel, *d, std::hypot(push_->after_px, kFillFloor_px)});
    });
    result_.seen_fraction =
        std::min(1.0, 1.0 - static_cast<double>(missing) / static_cast<double>(std::max<std::size_t>(1, all)));
    if (result_.seen_fraction < kLeastSeen || measured <= 0.0) {
      return refused(fmt::format("the camera sees {:.0f} % of what projector '{}' lights",
                                 100.0 * result_.seen_fraction, target().name));
    }
    if (more.empty()) return Done{};
    samples.insert(samples.end(), more.begin(), more.end());
    auto filled = fit_measured_map(old.width_px, old.height_px, samples);
    if (!filled) return std::move(filled).error().while_doing(fmt::format("mapping projector '{}'", target().name));
    filled->heldout_rms_px = map->heldout_rms_px;
    *map = *std::move(filled);
    return Done{};
  }

  /// Of places that a map of the others was not fitted to.
  [[nodiscard]] MeasuredRegistration registration_with(const Measurements& all, const MeasuredMap& map) const {
    Measurements held = all;
    std::erase_if(held.directions[0].correspondences, [](const Correspondence& place) {
      return place.projector == 0 &&
             !is_left_out({static_cast<double>(place.projector_x), static_cast<double>(place.projector_y)});
    });
    Calibration some;
    some.projectors.push_back({target().name, map});
    for (const std::size_t p : witness_maps_) some.projectors.push_back(before_.projectors[p]);
    return measured_registration(held, some);
  }

  Status follow_with_colours(const std::filesystem::path& folder) {
    const NearnessAt nearness = [this](const Eigen::Vector3d& d) { return wall_nearness(d); };
    auto followed =
        follow_light(calibration_folder(folder, before_.date), before_.projectors, calibration().projectors, nearness);
    if (!followed) return refused("brightness cannot follow (" + followed.error().message() + ")");
    if (!*followed) return Done{};
    light_ = std::move((*followed)->lighting);
    colours_ = std::move((*followed)->colours);
    outcome().light = std::move((*followed)->photometry);
    result_.has_colours = true;
    return Done{};
  }

  Status write(const std::filesystem::path& folder, const std::string& date) {
    auto& remarks = calibration().remarks;
    const std::string mine = fmt::format("projector '{}' {}", target().name, kRemark);
    std::erase_if(remarks, [&](const std::string& remark) { return remark.starts_with(mine); });
    remarks.push_back(mine + fmt::format("it had been turned by {:.2f} degrees and moved by {:.0f} mm; where it meets "
                                         "others they agree within {:.2f} px on 95 % of places, before {:.2f} px; all "
                                         "else is of {}",
                                         result_.turned_rad / kDegree, 1e3 * result_.moved_m,
                                         outcome().registration.p95_px, result_.before.p95_px, before_.date));
    if (result_.seen_fraction < 0.98) {
      remarks.push_back(
          fmt::format("projector '{}' {}the camera saw {:.0f} % of it, the rest is computed; calibrate "
                      "all projectors when there is time",
                      target().name, kRemark, 100.0 * result_.seen_fraction));
    }
    calibration().date = date;
    tell("writes the calibration", 0.97);
    std::vector<CalibrationPart> parts;
    if (result_.has_colours) {
      TRY_ASSIGN(CalibrationPart kept, light_part(calibration().projectors, light_));
      parts.push_back(std::move(kept));
    }
    TRY(save_calibration(folder, calibration(), colours_, parts));
    ReportFindings findings;
    const MeasuredRegistration& told = outcome().registration;
    findings.registration = {told.mean_px, told.p95_px, told.places};
    if (auto report = write_report(folder, calibration(), findings)) {
      outcome().report = *std::move(report);
    } else {
      remarks.push_back("there is no report page: " + report.error().message());
    }
    return Done{};
  }

  const Installation& installation_;
  const ScanSettings& settings_;
  const ScanDevices& devices_;
  const ScanListener& listener_;
  std::stop_token stop_;

  RealignmentOutcome result_;
  Calibration before_;
  std::optional<BrownLens> lens_;     ///< The camera's.
  std::size_t target_ = 0;            ///< Of the calibration's projectors,
  std::size_t target_installed_ = 0;  ///< and of the installation's.
  std::vector<Witness> witnesses_;
  std::vector<std::size_t> witness_maps_;  ///< Of the calibration's projectors.
  std::vector<InverseMap> inverses_;
  CameraStand planned_;
  CameraStand stand_;
  ScanView target_view_;
  WitnessView witness_view_;
  std::vector<MapSample> samples_;
  std::optional<PushFinding> push_;
  WallLighting light_;
  std::vector<CalibratedColour> colours_;
};

}  // namespace

Result<RealignmentOutcome> realign_projector(const Installation& installation, const std::string& projector,
                                             const ScanSettings& settings, const ScanDevices& devices,
                                             const std::filesystem::path& folder, const std::string& date,
                                             const Clock& clock, const ScanListener& listener, std::stop_token stop) {
  return Realigning(installation, settings, devices, listener, std::move(stop)).run(projector, folder, date, clock);
}

}  // namespace cyclorama
