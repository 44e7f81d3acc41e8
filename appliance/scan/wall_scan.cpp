// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/wall_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "appliance/scan/scan_view.h"

namespace cyclorama::scan {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
// A view with fewer correspondences is not used.
constexpr std::size_t kMinCorrespondences = 200;

ScanIdentity identity_of(const Installation& installation, const ScanPlan& plan, const ScanSettings& settings,
                         const ScanCamera& camera) {
  ScanIdentity identity;
  identity.camera = camera.id();
  identity.camera_width_px = camera.width_px();
  identity.camera_height_px = camera.height_px();
  for (const InstalledProjector& p : installation.projectors)
    identity.projectors.push_back({p.name, p.lens.width_px, p.lens.height_px});
  for (const ScanDirection& direction : plan.directions) identity.angles_rad.push_back(direction.angle_rad);
  identity.patterns = settings.view.text();
  return identity;
}

class WallScanning {
 public:
  WallScanning(const Installation& installation, const ScanSettings& settings, const ScanDevices& devices,
               const ScanListener& listener, std::stop_token stop)
      : installation_(installation),
        settings_(settings),
        devices_(devices),
        listener_(listener),
        stop_(std::move(stop)) {}

  Result<WallScan> run(const std::filesystem::path& folder) {
    ScanPlanOptions options;
    options.camera = settings_.camera;
    options.pitch_rad = settings_.pitch_rad;
    options.range = devices_.turntable.range();
    options.directions = settings_.directions;
    TRY_ASSIGN(plan_, plan_scan(installation_, options));
    scan_.remarks = plan_.remarks;
    for (const ScanDirection& direction : plan_.directions) views_ += direction.projectors.size();
    const ScanIdentity identity = identity_of(installation_, plan_, settings_, devices_.camera);
    TRY_ASSIGN(ScanFolder kept,
               settings_.resume ? ScanFolder::resume(folder, identity) : ScanFolder::begin(folder, identity));
    TRY(measure_all(&kept));
    TRY(refuse_dark_projectors(kept));
    for (const ScanView& view : kept.views()) scan_.pictures += view.pictures;
    scan_.measurements = measurements_of(kept);
    scan_.views = kept.views();
    return std::move(scan_);
  }

 private:
  Status measure_all(ScanFolder* kept) {
    for (std::size_t p = 0; p < installation_.projectors.size(); ++p) TRY(devices_.screen.show(p, RgbImage()));
    for (std::size_t d = 0; d < plan_.directions.size(); ++d) {
      const std::vector<std::size_t>& projectors = plan_.directions[d].projectors;
      if (is_complete(*kept, d)) {
        done_ += projectors.size();
        continue;
      }
      tell(fmt::format("turns the camera to {:.0f} degrees", plan_.directions[d].angle_rad / kDegree), 0.0, nullptr);
      TRY(turn_with_retry(devices_.turntable, plan_.directions[d].angle_rad));
      for (const std::size_t p : projectors) {
        if (stop_.stop_requested()) return cancelled();
        TRY_ASSIGN(ScanView view, undisturbed_view(d, p));
        TRY(kept->keep(std::move(view)));
        ++done_;
      }
    }
    return Done{};
  }

  /// Returns whether all views of a direction are stored. The turntable never stops twice at exactly the same angle, so
  /// all views of a direction must come from one stop, and an incomplete direction is measured anew. Views without
  /// light do not count, since the projector may have been switched on since.
  [[nodiscard]] bool is_complete(const ScanFolder& kept, std::size_t d) const {
    return std::ranges::all_of(plan_.directions[d].projectors, [&](std::size_t p) {
      const ScanView* before = kept.find(d, p);
      return before != nullptr && before->correspondences.size() >= kMinCorrespondences;
    });
  }

  /// Measures a view, and measures it once more if somebody was in the way; returns the better view.
  Result<ScanView> undisturbed_view(std::size_t d, std::size_t p) {
    TRY_ASSIGN(ScanView view, view_of(d, p));
    if (view.disturbed <= settings_.max_disturbed) return view;
    ++scan_.retries;
    TRY_ASSIGN(ScanView again, view_of(d, p));
    const int pictures = view.pictures + again.pictures;
    if (again.disturbed <= view.disturbed) view = std::move(again);
    view.pictures = pictures;
    if (view.disturbed > settings_.max_disturbed) {
      scan_.remarks.push_back(
          fmt::format("while projector '{}' was measured at {:.0f} degrees something moved before {:.0f} % of its "
                      "light, twice; keep "
                      "people away from the wall, and switch off what flickers",
                      installation_.projectors[p].name, view.angle_rad / kDegree, 100.0 * view.disturbed));
    }
    return view;
  }

  Result<ScanView> view_of(std::size_t d, std::size_t p) {
    const InstalledProjector& projector = installation_.projectors[p];
    const ViewOrder order{p, projector.name, projector.lens.width_px, projector.lens.height_px, exposure_s_};
    const PhotographListener photographed = [&](const std::string& picture, double fraction,
                                                const ScanPhotograph& photograph) {
      tell(fmt::format("measures projector '{}' at {:.0f} degrees: {}", projector.name,
                       plan_.directions[d].angle_rad / kDegree, picture),
           fraction, &photograph);
    };
    auto view = measure_view(order, settings_.view, devices_.screen, devices_.camera, photographed, stop_);
    if (!view) return view;
    if (view->exposure_s > 0.0) exposure_s_ = view->exposure_s;
    view->direction = d;
    TRY_ASSIGN(view->angle_rad, devices_.turntable.angle());
    return view;
  }

  void tell(const std::string& step, double fraction_of_view, const ScanPhotograph* newest) {
    const double fraction =
        (static_cast<double>(done_) + fraction_of_view) / static_cast<double>(std::max<std::size_t>(1, views_));
    // A view that is measured again does not decrease the progress.
    told_ = std::max(told_, std::min(fraction, 1.0));
    if (listener_) listener_({step, told_, newest});
  }

  [[nodiscard]] Status refuse_dark_projectors(const ScanFolder& kept) const {
    std::vector<std::size_t> correspondences(installation_.projectors.size(), 0);
    for (const ScanView& view : kept.views()) correspondences[view.projector] += view.correspondences.size();
    for (std::size_t p = 0; p < correspondences.size(); ++p) {
      if (correspondences[p] >= kMinCorrespondences) continue;
      return Error(
          ErrorCode::kUnavailable,
          fmt::format("projector '{}' lights nothing that the camera sees, in any of {} directions; switch it "
                      "on, take its cover off, darken the room, see that its cable's picture arrives, then resume",
                      installation_.projectors[p].name, plan_.directions.size()));
    }
    return Done{};
  }

  [[nodiscard]] solve::Measurements measurements_of(const ScanFolder& kept) const {
    solve::Measurements measurements;
    measurements.camera = settings_.camera;
    measurements.pitch_rad = settings_.pitch_rad;
    measurements.wall_distance_m = plan_.wall_distance_m;
    measurements.wall_distance_sigma_m = plan_.wall_distance_sigma_m;
    for (const InstalledProjector& p : installation_.projectors) {
      solve::MeasuredProjector projector{p.name, p.lens.width_px, p.lens.height_px, {}};
      solve::ProjectorPosePrior position;
      position.lens = calibration::MeasuredLens::from_focal(p.lens.width_px, p.lens.height_px, p.lens.focal_px);
      position.lens.values[calibration::MeasuredLens::kCentreU] = p.lens.centre_u_px;
      position.lens.values[calibration::MeasuredLens::kCentreV] = p.lens.centre_v_px;
      // The Eye frame has the Room's axes; its origin is the sweet spot.
      position.T_eye_projector = {p.T_room_projector.rotation(),
                                  p.T_room_projector.translation() - installation_.sweet_spot.xyz};
      projector.position = position;
      measurements.projectors.push_back(std::move(projector));
    }
    for (std::size_t d = 0; d < plan_.directions.size(); ++d) {
      solve::TurntableDirection direction;
      direction.angle_rad = plan_.directions[d].angle_rad;
      direction.sigma_rad = settings_.turntable_sigma_rad;
      for (const ScanView& view : kept.views()) {
        if (view.direction != d || view.correspondences.size() < kMinCorrespondences) continue;
        direction.angle_rad = view.angle_rad;
        direction.correspondences.insert(direction.correspondences.end(), view.correspondences.begin(),
                                         view.correspondences.end());
      }
      if (!direction.correspondences.empty()) measurements.directions.push_back(std::move(direction));
    }
    return measurements;
  }

  const Installation& installation_;
  const ScanSettings& settings_;
  const ScanDevices& devices_;
  const ScanListener& listener_;
  std::stop_token stop_;
  ScanPlan plan_;
  WallScan scan_;
  std::optional<double> exposure_s_;
  std::size_t views_ = 0;
  std::size_t done_ = 0;
  double told_ = 0.0;
};

}  // namespace

Status turn_with_retry(turntable::Turntable& turntable, double angle_rad) {
  if (!turntable.is_homed()) TRY(turntable.home());
  auto turn = turntable.turn_to(angle_rad);
  if (turn) return turn;
  const ErrorCode code = turn.error().code();
  if (code != ErrorCode::kTimedOut && code != ErrorCode::kBadData) return turn;
  TRY(turntable.home());
  return turntable.turn_to(angle_rad);
}

calibration::MeasuredLens data_sheet_lens(int width_px, int height_px, double field_of_view_rad) {
  calibration::MeasuredLens lens =
      calibration::MeasuredLens::from_focal(width_px, height_px, 0.5 * width_px / std::tan(0.5 * field_of_view_rad));
  const auto allow = [&](calibration::MeasuredLens::Parameter parameter, double sigma) {
    lens.covariance(parameter, parameter) = sigma * sigma;
  };
  // Prior deviations of the distortion: camera lenses seldom have more than a few percent of barrel distortion.
  allow(calibration::MeasuredLens::kK1, 0.15);
  allow(calibration::MeasuredLens::kK2, 0.05);
  allow(calibration::MeasuredLens::kP1, 0.001);
  allow(calibration::MeasuredLens::kP2, 0.001);
  return lens;
}

Result<WallScan> scan_wall(const Installation& installation, const ScanSettings& settings, const ScanDevices& devices,
                           const std::filesystem::path& folder, const ScanListener& listener, std::stop_token stop) {
  return WallScanning(installation, settings, devices, listener, std::move(stop)).run(folder);
}

}  // namespace cyclorama::scan
