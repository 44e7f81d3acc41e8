// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/realign/realignment.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "appliance/calibration/calibration_file.h"
#include "appliance/photometry/followed_light.h"
#include "appliance/photometry/light_file.h"
#include "appliance/scan/realign/baseline.h"
#include "appliance/scan/realign/new_map.h"
#include "appliance/scan/realign/photographs.h"
#include "appliance/scan/report_page.h"

namespace cyclorama::scan {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr const char* kRemark = "was measured anew alone: ";
constexpr double kNearlyAll = 0.98;  // If at least this fraction of a map was measured, no remark mentions the rest.

void report_step(const ScanListener& listener, const std::string& step, double fraction) {
  if (listener) listener({step, fraction, nullptr});
}

/// Returns the geometric part of the result; writes nothing.
RealignmentOutcome outcome_of(const RealignmentBaseline& baseline, const RealignmentPhotographs& photographs,
                              const NewMap& found) {
  RealignmentOutcome result;
  CalibrationOutcome& outcome = result.outcome;
  outcome.calibration = baseline.calibration;
  outcome.pictures = photographs.pictures;
  outcome.retries = photographs.retries;
  outcome.registration = found.before;
  result.before = found.before;
  result.camera_moved_m = found.camera_moved_m;
  auto& remarks = outcome.calibration.remarks;
  remarks.insert(remarks.end(), photographs.remarks.begin(), photographs.remarks.end());
  if (!found.displaced) {
    remarks.push_back(fmt::format("projector '{}' stands where it stood, within {:.2f} px: nothing was changed",
                                  baseline.projector().name, found.old_error_px));
    return result;
  }
  const Displacement& displacement = found.displaced->displacement;
  result.has_moved = true;
  result.turned_rad = displacement.turned_rad;
  result.moved_m = displacement.moved_m;
  result.explained_px = displacement.after_px;
  result.seen_fraction = found.displaced->seen_fraction;
  outcome.registration = found.displaced->registration;
  outcome.calibration.wall->fit.projectors[baseline.target] = displacement.projector;
  for (calibration::CalibratedProjector& p : outcome.calibration.projectors) p.is_previous = true;
  calibration::CalibratedProjector& moved = outcome.calibration.projectors[baseline.target];
  moved.map = found.displaced->map;
  moved.is_previous = false;
  return result;
}

/// Returns masks and colours of all projectors for the new map; nothing if the previous calibration had none.
Result<std::optional<photometry::FollowedLight>> follow_with_colours(const RealignmentBaseline& baseline,
                                                                     const calibration::Calibration& calibration,
                                                                     const std::filesystem::path& folder) {
  auto followed = photometry::follow_light(calibration::calibration_folder(folder, baseline.calibration.date),
                                           baseline.calibration.projectors, calibration.projectors,
                                           [&](const Eigen::Vector3d& d) { return baseline.wall_inverse_depth(d); });
  if (!followed) return realignment_refused("brightness cannot follow (" + followed.error().message() + ")");
  return followed;
}

/// Replaces the remarks of an earlier realignment of this projector.
void add_remarks(const RealignmentBaseline& baseline, RealignmentOutcome* result) {
  auto& remarks = result->outcome.calibration.remarks;
  const std::string mine = fmt::format("projector '{}' {}", baseline.projector().name, kRemark);
  std::erase_if(remarks, [&](const std::string& remark) { return remark.starts_with(mine); });
  remarks.push_back(mine + fmt::format("it had been turned by {:.2f} degrees and moved by {:.0f} mm; where it meets "
                                       "others they agree within {:.2f} px on 95 % of places, before {:.2f} px; all "
                                       "else is of {}",
                                       result->turned_rad / kDegree, 1e3 * result->moved_m,
                                       result->outcome.registration.p95_px, result->before.p95_px,
                                       baseline.calibration.date));
  if (result->seen_fraction < kNearlyAll) {
    remarks.push_back(mine + fmt::format("the camera saw {:.0f} % of it, the rest is computed; calibrate "
                                         "all projectors when there is time",
                                         100.0 * result->seen_fraction));
  }
}

/// Writes the calibration with its masks and colours, then the report. A report that cannot be written is no error.
Status write(const std::filesystem::path& folder, const std::optional<photometry::FollowedLight>& light,
             CalibrationOutcome* outcome) {
  std::vector<calibration::CalibrationPart> parts;
  if (light) {
    TRY_ASSIGN(calibration::CalibrationPart kept,
               photometry::light_part(outcome->calibration.projectors, light->lighting));
    parts.push_back(std::move(kept));
  }
  const std::vector<calibration::CalibratedColour> colours =
      light ? light->colours : std::vector<calibration::CalibratedColour>();
  TRY(calibration::save_calibration(folder, outcome->calibration, colours, parts));
  const solve::MeasuredRegistration& registration = outcome->registration;
  ReportFindings findings;
  findings.registration = {registration.mean_px, registration.p95_px, registration.correspondences};
  if (auto report = write_report(folder, outcome->calibration, findings)) {
    outcome->report = *std::move(report);
  } else {
    outcome->calibration.remarks.push_back("there is no report page: " + report.error().message());
  }
  return Done{};
}

}  // namespace

Result<RealignmentOutcome> realign_projector(const Installation& installation, const std::string& projector,
                                             const ScanSettings& settings, const ScanDevices& devices,
                                             const std::filesystem::path& folder, const std::string& date,
                                             const Clock& clock, const ScanListener& listener, std::stop_token stop) {
  const TimePoint begun = clock.now();
  TRY_ASSIGN(const RealignmentBaseline baseline,
             read_baseline(installation, projector, folder, devices.camera.width_px(), devices.camera.height_px()));
  TRY_ASSIGN(const RealignmentPhotographs photographs,
             photograph_displaced(baseline, installation, settings, devices, listener, stop));
  const TimePoint scanned = clock.now();
  report_step(listener, "finds out where it stands now", 0.85);
  TRY_ASSIGN(const NewMap found, find_new_map(baseline, photographs));
  RealignmentOutcome result = outcome_of(baseline, photographs, found);
  std::optional<photometry::FollowedLight> light;
  if (result.has_moved) {
    TRY_ASSIGN(light, follow_with_colours(baseline, result.outcome.calibration, folder));
    result.has_colours = light.has_value();
    if (light) result.outcome.light = light->photometry;
  }
  result.outcome.scan_s = to_seconds(scanned - begun);
  result.outcome.solve_s = to_seconds(clock.now() - scanned);
  if (stop.stop_requested()) return cancelled();
  if (result.has_moved) {
    add_remarks(baseline, &result);
    result.outcome.calibration.date = date;
    report_step(listener, "writes the calibration", 0.97);
    TRY(write(folder, light, &result.outcome));
  }
  report_step(listener, result.has_moved ? "is calibrated" : "stands where it stood", 1.0);
  return result;
}

}  // namespace cyclorama::scan
