// SPDX-License-Identifier: Apache-2.0
/// One calibration from beginning to end:
///
///     scan_wall() ─▶ scan_light() ─▶ calibrate() ─▶ photometry() ─▶ photograph_seams() ─▶ save_calibration()
///         │ FOLDER/scan: the views so far, for resuming           FOLDER/calibration.json and the files it names
#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

#include "appliance/photometry/photometry.h"
#include "appliance/scan/wall_scan.h"
#include "appliance/solve/calibrate.h"
#include "appliance/solve/registration.h"
#include "common/base/clock.h"

namespace cyclorama::scan {

struct CalibrationOutcome {
  calibration::Calibration calibration;  ///< Its remarks include those of the scan.
  solve::MeasuredRegistration registration;
  std::optional<photometry::Photometry> light;  ///< Absent if it could not be measured; a remark gives the reason.
  std::filesystem::path report;  ///< HTML page for the installer; empty if it could not be written (a remark says why).
  int pictures = 0;
  int retries = 0;
  double scan_s = 0.0;  ///< Measured with the given clock; for a simulated museum: computing time, not simulated time.
  double solve_s = 0.0;
  double seams_s = 0.0;
};

/// `date` names the calibration: "2026-11-22T13-05-00Z". The previous calibration is never replaced by a worse one. If
/// brightness and colour cannot be measured, the previous ones are carried over to the new maps; if there are none,
/// only the geometry is written. If the seams cannot be photographed, the report lacks them. A remark gives the remedy
/// in each case.
/// Errors: those of scan_wall(), scan_light(), calibrate() and save_calibration(), each with its remedy; the previous
/// calibration then stays in force. Blocks for minutes.
Result<CalibrationOutcome> run_calibration(const Installation& installation, const ScanSettings& settings,
                                           const ScanDevices& devices, const std::filesystem::path& folder,
                                           const std::string& date, const Clock& clock, const ScanListener& listener,
                                           std::stop_token stop);

/// Returns the current time in UTC in the format that save_calibration() expects.
[[nodiscard]] std::string calibration_date();

}  // namespace cyclorama::scan
