// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/realign/photographs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "appliance/scan/realign/map_points.h"
#include "appliance/scan/realign/wall_direction.h"

namespace cyclorama::scan {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
// Finer bits need more pictures, and cells of many pixels do not benefit from them: docs/design/calibration.md.
constexpr int kMinFinestBit = 2;
constexpr int kHeadings = 15;  // Candidate headings on either side of the projector's middle.
constexpr double kHeadingStep_rad = 1.0 * kDegree;
constexpr double kTargetRim = 0.08;  // Fraction of the camera's picture; the displaced light is not quite where it was.
constexpr double kReferenceRim = 0.02;
constexpr double kReferenceGain = 0.3;  // Gain per direction of a reference; 1 for the displaced projector.
constexpr int kManyPixels = 1000;       // Camera width above which every other pixel is enough.
constexpr double kInside = 1.0 / 240;   // Margin within a reference projector's picture, in widths.

bool is_in_view(const RealignmentBaseline& baseline, const LocatedCamera& camera, const Eigen::Vector3d& d,
                double rim) {
  const auto pixel =
      baseline.lens.pixel_of(camera.R_camera_eye * (d - baseline.camera_inverse_depth(d) * camera.centre_m));
  if (!pixel) return false;
  const double u = pixel->x() / baseline.calibration.turntable.camera.width_px;
  const double v = pixel->y() / baseline.calibration.turntable.camera.height_px;
  return u >= rim && u <= 1.0 - rim && v >= rim && v <= 1.0 - rim;
}

double best_angle(const RealignmentBaseline& baseline, const turntable::TurnRange& range) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for_points(baseline.projector().map, [&](const Eigen::Vector2d&, const Eigen::Vector3d& d) { middle += d; });
  const double towards = std::atan2(middle.x(), -middle.z());
  const auto& projectors = baseline.calibration.projectors;
  double best = std::clamp(towards, range.min_rad, range.max_rad);
  double best_gain = -1.0;
  for (int i = -kHeadings; i <= kHeadings; ++i) {
    const double angle = std::remainder(towards + i * kHeadingStep_rad, 2.0 * std::numbers::pi);
    if (angle < range.min_rad || angle > range.max_rad) continue;
    const LocatedCamera camera = planned_camera(baseline.calibration.turntable, angle);
    double gain = -1e-3 * std::abs(i);  // Prefers the direct heading if all else is equal.
    int n = 0;
    for (std::size_t p = 0; p < projectors.size(); ++p) {
      const bool is_target = p == baseline.target;
      for_points(projectors[p].map, [&](const Eigen::Vector2d&, const Eigen::Vector3d& d) {
        if (n++ % 5 != 0) return;
        if (is_in_view(baseline, camera, d, is_target ? kTargetRim : kReferenceRim))
          gain += is_target ? 1.0 : kReferenceGain;
      });
    }
    if (gain > best_gain) {
      best_gain = gain;
      best = angle;
    }
  }
  return best;
}

/// Returns the settings without fine patterns, which averages over cells do not need.
ViewSettings coarse(ViewSettings settings) {
  settings.finest_bit = std::max(settings.finest_bit, kMinFinestBit);
  settings.phase_period_px = 0.0;
  settings.phase_steps = 0;
  if (settings.base_bit >= 0) settings.base_bit = std::max(settings.base_bit, settings.finest_bit);
  return settings;
}

PhotographListener telling(const ScanListener& listener, std::string what, double from, double span) {
  return [&listener, what = std::move(what), from, span](const std::string& picture, double fraction,
                                                         const ScanPhotograph& photograph) {
    if (listener) listener({what + picture, from + span * fraction, &photograph});
  };
}

/// Measures the displaced projector, and measures it once more if somebody was in the way; keeps the better view.
Status photograph_target(const RealignmentBaseline& baseline, const ScanSettings& settings, const ScanDevices& devices,
                         const ScanListener& listener, const std::stop_token& stop, RealignmentPhotographs* all) {
  const calibration::CalibratedProjector& target = baseline.projector();
  const ViewSettings view_settings = coarse(settings.view);
  const ViewOrder order{baseline.target_installed, target.name, target.map.width_px, target.map.height_px, {}};
  const auto measured = [&](const PhotographListener& photographed) {
    return measure_view(order, view_settings, devices.screen, devices.camera, photographed, stop);
  };
  TRY_ASSIGN(ScanView view,
             measured(telling(listener, fmt::format("measures projector '{}': ", target.name), 0.05, 0.6)));
  all->pictures += view.pictures;
  if (view.disturbed > settings.max_disturbed) {
    // The progress stays constant during the second measurement, since it may not decrease.
    TRY_ASSIGN(ScanView second,
               measured(telling(listener, fmt::format("measures projector '{}' once more: ", target.name), 0.65, 0.0)));
    all->pictures += second.pictures;
    ++all->retries;
    if (second.disturbed < view.disturbed) view = std::move(second);
    if (view.disturbed > settings.max_disturbed) {
      all->remarks.push_back(
          fmt::format("projector '{}': something moved before {:.0f} % of its light; keep visitors away", target.name,
                      100.0 * view.disturbed));
    }
  }
  if (!(view.exposure_s > 0.0) || view.correspondences.empty()) {
    return Error(ErrorCode::kUnavailable,
                 fmt::format("the camera sees no light of projector '{}': switch it on, take its cover off, or turn "
                             "it back towards the wall",
                             target.name));
  }
  all->target = std::move(view);
  return Done{};
}

/// Predicts which reference projector's pixel each camera pixel should see; pixels near a picture's edge or in an
/// overlap are not used.
ExpectedReferences expected_from(const RealignmentBaseline& baseline, const LocatedCamera& camera) {
  const int width = baseline.calibration.turntable.camera.width_px;
  const int height = baseline.calibration.turntable.camera.height_px;
  ExpectedReferences expected{Image<float, 2>(width, height), Image<std::int16_t, 1>(width, height, -1)};
  const InverseDepthAt inverse_depth = [&](const Eigen::Vector3d& d) { return baseline.camera_inverse_depth(d); };
  const int every = width > kManyPixels ? 2 : 1;
  for (int y = 0; y < height; y += every) {
    for (int x = 0; x < width; x += every) {
      const auto ray = calibration::direction_through(baseline.lens, {x + 0.5, y + 0.5});
      if (!ray) continue;
      const auto d = wall_direction_from(camera.centre_m, camera.R_camera_eye.transpose() * *ray, inverse_depth);
      if (!d) continue;
      int sees = 0;
      for (std::size_t r = 0; r < baseline.references.size(); ++r) {
        const ReferenceProjector& reference = baseline.references[r];
        const auto pixel = baseline.reference_maps[r].pixels.pixel_at(*d);
        if (!pixel) continue;
        ++sees;
        const double rim = std::max(2.0, kInside * reference.width_px);
        const bool is_inside = pixel->x() > rim && pixel->x() < reference.width_px - rim && pixel->y() > rim &&
                               pixel->y() < reference.height_px - rim;
        if (!is_inside) ++sees;
        expected.pixel_px.at(x, y)[0] = static_cast<float>(pixel->x());
        expected.pixel_px.at(x, y)[1] = static_cast<float>(pixel->y());
        *expected.reference.at(x, y) = static_cast<std::int16_t>(r);
      }
      if (sees != 1) *expected.reference.at(x, y) = -1;
    }
  }
  return expected;
}

}  // namespace

Result<RealignmentPhotographs> photograph_displaced(const RealignmentBaseline& baseline,
                                                    const Installation& installation, const ScanSettings& settings,
                                                    const ScanDevices& devices, const ScanListener& listener,
                                                    const std::stop_token& stop) {
  RealignmentPhotographs all;
  const double angle = best_angle(baseline, devices.turntable.range());
  if (listener) listener({fmt::format("turns the camera to {:.0f} degrees", angle / kDegree), 0.0, nullptr});
  TRY(turn_with_retry(devices.turntable, angle));
  for (std::size_t p = 0; p < installation.projectors.size(); ++p) TRY(devices.screen.show(p, RgbImage()));
  all.planned = planned_camera(baseline.calibration.turntable, angle);
  TRY(photograph_target(baseline, settings, devices, listener, stop, &all));
  TRY_ASSIGN(all.references,
             measure_references(baseline.references, expected_from(baseline, all.planned), all.target.exposure_s,
                                settings.view.exposure, devices.screen, devices.camera,
                                telling(listener, "looks at the other projectors: ", 0.65, 0.2), stop));
  all.pictures += all.references.pictures;
  return all;
}

}  // namespace cyclorama::scan
