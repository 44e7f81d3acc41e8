// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/calibration_run.h"

#include <fmt/format.h>

#include <ctime>
#include <optional>

#include "appliance/calibration/calibration_file.h"
#include "appliance/photometry/followed_light.h"
#include "appliance/photometry/light_file.h"
#include "appliance/scan/light_scan.h"
#include "appliance/scan/report_page.h"
#include "appliance/scan/seam_photographs.h"

namespace cyclorama::scan {
namespace {
constexpr double kWallPart = 0.7;  // Progress at the end of each step, as a fraction of the whole.
constexpr double kLightPart = 0.9;
constexpr double kSolvePart = 0.94;
constexpr double kSeamPart = 0.98;

/// Adds the calibration's maps to the scanned light, and computes the photometry.
Result<photometry::Photometry> photometry_of(LightScan light, const calibration::Calibration& calibration) {
  for (const calibration::CalibratedProjector& projector : calibration.projectors)
    light.input.projectors.push_back({projector.name, projector.map});
  const calibration::MeasuredLens& lens = calibration.turntable.camera;
  light.input.camera_centre_px = Eigen::Vector2d(lens.values[calibration::MeasuredLens::kCentreU],
                                                 lens.values[calibration::MeasuredLens::kCentreV]);
  return photometry::photometry(light.input);
}

std::vector<calibration::CalibratedColour> colours_of(const photometry::Photometry& photometry,
                                                      const calibration::Calibration& calibration) {
  std::vector<calibration::CalibratedColour> colours;
  for (std::size_t p = 0; p < photometry.heads.size(); ++p)
    colours.push_back({calibration.projectors[p].name, photometry.heads[p].mask, photometry.heads[p].colour});
  return colours;
}

/// Carries the previous masks and colours over to the new maps. Returns nothing if there were none or they are
/// unusable; the wall is then shown without measured brightness and colours.
std::optional<photometry::FollowedLight> light_of_before(const std::filesystem::path& folder,
                                                         const std::optional<calibration::Calibration>& previous,
                                                         const calibration::Calibration& calibration) {
  if (!previous) return std::nullopt;
  // Projectors that did not move light the wall as before; for a displaced projector the solid angle gives the change
  // of light.
  auto followed =
      photometry::follow_light(calibration::calibration_folder(folder, previous->date), previous->projectors,
                               calibration.projectors, [](const Eigen::Vector3d&) { return 1.0; });
  if (!followed) return std::nullopt;
  return *std::move(followed);
}

/// Photographs the wall as drawn by the previous calibration (or by installation.toml alone) and by the new one.
Result<SeamPhotographs> seams_before_and_after(const Installation& installation, const ScanSettings& settings,
                                               const ScanDevices& devices, const std::filesystem::path& folder,
                                               const std::vector<ScanView>& views,
                                               const calibration::Calibration* previous,
                                               const calibration::Calibration& calibration,
                                               const std::vector<calibration::CalibratedColour>& colours,
                                               const ScanListener& listener, std::stop_token stop) {
  std::vector<calibration::CalibratedColour> old_colours;
  if (previous != nullptr) {
    // Unreadable colours are left out, as in a display.
    if (auto read = calibration::read_colours(calibration::calibration_folder(folder, previous->date)))
      old_colours = *std::move(read);
  }
  double exposure_s = settings.view.exposure.longest.count();
  for (const ScanView& view : views) {
    if (view.exposure_s > 0.0) exposure_s = std::min(exposure_s, view.exposure_s);
  }
  const DrawnBy before{previous == nullptr ? "before, by installation.toml" : "before, of " + previous->date, previous,
                       old_colours};
  return photograph_seams(installation, before, {"after", &calibration, colours}, exposure_s, devices, listener,
                          std::move(stop));
}

}  // namespace

Result<CalibrationOutcome> run_calibration(const Installation& installation, const ScanSettings& settings,
                                           const ScanDevices& devices, const std::filesystem::path& folder,
                                           const std::string& date, const Clock& clock, const ScanListener& listener,
                                           std::stop_token stop) {
  const auto tell = [&](const std::string& step, double fraction) {
    if (listener) listener({step, fraction, nullptr});
  };
  CalibrationOutcome outcome;
  TimePoint begun = clock.now();
  const auto part = [&](double from, double to) -> ScanListener {
    return [&listener, from, to](const ScanProgress& progress) {
      if (listener) listener({progress.step, from + (to - from) * progress.fraction, progress.newest});
    };
  };
  TRY_ASSIGN(WallScan scan, scan_wall(installation, settings, devices, folder / "scan", part(0.0, kWallPart), stop));
  TRY_ASSIGN(LightScan light,
             scan_light(installation, scan.views, settings.view.exposure, devices, part(kWallPart, kLightPart), stop));
  outcome.pictures = scan.pictures + light.pictures;
  outcome.retries = scan.retries;
  outcome.scan_s = to_seconds(clock.now() - begun);

  tell("finds out where everything is", kLightPart);
  begun = clock.now();
  // An unreadable previous calibration does not prevent a new one; only their comparison is omitted.
  std::optional<calibration::Calibration> previous;
  if (auto read = calibration::read_calibration(folder)) {
    previous = *std::move(read);
  } else if (read.error().code() != ErrorCode::kNotFound) {
    scan.remarks.push_back("the previous calibration was not compared: " + read.error().message());
  }
  solve::CalibrateOptions options;
  options.with_wall = settings.with_wall;
  options.previous = previous ? &*previous : nullptr;
  TRY_ASSIGN(outcome.calibration, solve::calibrate(scan.measurements, date, options));
  outcome.registration = solve::measured_registration(scan.measurements, outcome.calibration);
  std::vector<calibration::CalibratedColour> colours;
  std::optional<photometry::WallLighting> lighting;
  if (auto found = photometry_of(std::move(light), outcome.calibration)) {
    scan.remarks.insert(scan.remarks.end(), found->remarks.begin(), found->remarks.end());
    colours = colours_of(*found, outcome.calibration);
    if (found->lighting) lighting = *found->lighting;
    outcome.light = *std::move(found);
  } else if (auto kept = light_of_before(folder, previous, outcome.calibration)) {
    scan.remarks.push_back(
        fmt::format("brightness and colours are those of {}: {}", previous->date, found.error().message()));
    colours = std::move(kept->colours);
    lighting = std::move(kept->lighting);
  } else {
    scan.remarks.push_back("the wall is shown without measured brightness and colours: " + found.error().message());
  }
  outcome.solve_s = to_seconds(clock.now() - begun);
  ReportFindings findings;
  if (settings.with_seams) {
    begun = clock.now();
    auto seams = seams_before_and_after(installation, settings, devices, folder, scan.views, options.previous,
                                        outcome.calibration, colours, part(kSolvePart, kSeamPart), stop);
    outcome.seams_s = to_seconds(clock.now() - begun);
    if (seams) {
      outcome.pictures += seams->pictures;
      findings.photographs = std::move(seams->photographs);
    } else {
      scan.remarks.push_back("the seams were not photographed: " + seams.error().message());
    }
  }
  auto& remarks = outcome.calibration.remarks;
  remarks.insert(remarks.begin(), scan.remarks.begin(), scan.remarks.end());
  if (stop.stop_requested()) return cancelled();
  tell("writes the calibration", kSeamPart);
  std::vector<calibration::CalibrationPart> parts;
  if (lighting) {
    TRY_ASSIGN(calibration::CalibrationPart kept, photometry::light_part(outcome.calibration.projectors, *lighting));
    parts.push_back(std::move(kept));
  }
  TRY(calibration::save_calibration(folder, outcome.calibration, colours, parts));
  ScanFolder::end(folder / "scan");
  findings.residuals = wall_residuals(scan.measurements, outcome.calibration);
  findings.registration = {outcome.registration.mean_px, outcome.registration.p95_px,
                           outcome.registration.correspondences};
  if (auto report = write_report(folder, outcome.calibration, findings)) {
    outcome.report = *std::move(report);
  } else {
    remarks.push_back("there is no report page: " + report.error().message());
  }
  tell("is calibrated", 1.0);
  return outcome;
}

std::string calibration_date() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  const std::size_t length = std::strftime(text, sizeof text, "%Y-%m-%dT%H-%M-%SZ", &utc);
  return {text, length};
}

}  // namespace cyclorama::scan
