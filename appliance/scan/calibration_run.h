// SPDX-License-Identifier: Apache-2.0
/// One calibration from beginning to end:
///
///     scan_wall() ─▶ scan_light() ─▶ calibrate() ─▶ photometry() ─▶ photograph_seams() ─▶ save_calibration()
///         │ FOLDER/scan: what was seen, to go on with                   FOLDER/calibration.json and what it names
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
  calibration::Calibration calibration;  ///< With the scan's remarks among its own.
  solve::MeasuredRegistration registration;
  std::optional<photometry::Photometry> light;  ///< Absent where it could not be measured: a remark says why.
  std::filesystem::path report;  ///< The page for the installer; empty: it could not be written, a remark says why.
  int pictures = 0;
  int retries = 0;
  double scan_s = 0.0;  ///< By the clock that was given: of a simulated museum these are its computer's, not its own.
  double solve_s = 0.0;
  double seams_s = 0.0;
};

/// `date` names the calibration: "2026-11-22T13-05-00Z". The one of before is never replaced by a worse one.
/// Where brightness and colour cannot be found, those of before are carried over to the new maps, or, where there were
/// none, the geometry is all that is written; a remark says what to do;
/// likewise where seams cannot be photographed.
/// Errors of scan_wall(), scan_light(), calibrate() and save_calibration(), each with its remedy; the calibration that
/// counts is the one of before then. Blocks, for minutes.
Result<CalibrationOutcome> run_calibration(const Installation& installation, const ScanSettings& settings,
                                           const ScanDevices& devices, const std::filesystem::path& folder,
                                           const std::string& date, const Clock& clock, const ScanListener& listener,
                                           std::stop_token stop);

/// Now, in UTC, as save_calibration() wants it.
[[nodiscard]] std::string calibration_date();

}  // namespace cyclorama::scan
