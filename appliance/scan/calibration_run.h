// SPDX-License-Identifier: Apache-2.0
/// One calibration from beginning to end:
///
///     scan_wall() ─▶ scan_light() ─▶ calibrate() ─▶ photometry() ─▶ photograph_seams() ─▶ save_calibration()
///         │ FOLDER/scan: views for resuming           FOLDER/calibration.json and the files it names
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
  double scan_s = 0.0;  ///< Measured with the given clock; in a simulated museum, computing time.
  double solve_s = 0.0;
  double seams_s = 0.0;
};

/// Calibrates the installation and saves the result under FOLDER/calibrations/`date`; `date` is from
/// calibration_date(). A worse calibration never replaces the previous one. If brightness and colour cannot be
/// measured, the previous ones are carried over to the new maps; if there are none, only the geometry is written. If
/// the seams cannot be photographed, the report lacks them. A remark gives the remedy in each case. Errors: those of
/// scan_wall(), scan_light(), calibrate() and save_calibration(), each with its remedy; after an error the previous
/// calibration stays in force. Blocks for minutes.
Result<CalibrationOutcome> run_calibration(const Installation& installation, const ScanSettings& settings,
                                           const ScanDevices& devices, const std::filesystem::path& folder,
                                           const std::string& date, const Clock& clock, const ScanListener& listener,
                                           std::stop_token stop);

/// Returns the current time in UTC in the format that save_calibration() expects: "2026-11-22T13-05-00Z".
[[nodiscard]] std::string calibration_date();

}  // namespace cyclorama::scan
