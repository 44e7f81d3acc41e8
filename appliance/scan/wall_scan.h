// SPDX-License-Identifier: Apache-2.0
/// The scan of the whole wall: turns the turntable, lights one projector after another, and stores the views.
///
///     for each direction:  turn ─▶ for each projector that is seen from here:  measure_view() ─▶ ScanFolder
///                                        ▲ once more, if somebody walked through  │
///                                        └────────────────────────────────────────┘
#pragma once

#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "appliance/scan/scan_plan.h"
#include "appliance/scan/scan_view.h"
#include "appliance/scan/view_measuring.h"
#include "appliance/solve/measurements.h"
#include "drivers/turntable/turntable.h"

namespace cyclorama::scan {

/// Devices that a scan uses; all are borrowed.
struct ScanDevices {
  PatternScreen& screen;
  ScanCamera& camera;
  turntable::Turntable& turntable;
  /// The same camera with colour filters, if `camera` is used without them: it measures brightness and colour. May be
  /// null.
  ScanCamera* colour_camera = nullptr;
};

struct ScanSettings {
  calibration::MeasuredLens camera;   ///< Lens with the covariance of its calibration, or of a data sheet.
  double pitch_rad = 0.0;             ///< Approximate upward tilt of the camera.
  double turntable_sigma_rad = 1e-3;  ///< Standard deviation of the turntable's angles.
  ViewSettings view{};
  int directions = 0;           ///< See ScanPlanOptions::directions.
  double max_disturbed = 0.02;  ///< Fraction of the lit pixels above which the view is measured once more.
  bool resume = false;
  bool with_seams = true;  ///< Photographs the seams for the report, which takes some seconds.
  bool with_wall = true;   ///< Also fits the wall, for eyes off the sweet spot; takes most of the solving time.
};

/// Turns the turntable to an angle. If it stalls, it has lost its position, and is homed and turned once more. Errors:
/// those of Turntable.
Status turn_with_retry(turntable::Turntable& turntable, double angle_rad);

/// Returns a lens of which only the field of view is known, as from a data sheet; the bundle adjustment over the
/// directions refines it.
[[nodiscard]] calibration::MeasuredLens data_sheet_lens(int width_px, int height_px, double field_of_view_rad);

struct ScanProgress {
  std::string step;       ///< One sentence for people.
  double fraction = 0.0;  ///< Fraction of the scan, 0 to 1; never decreases.
  /// Null between photographs; valid during the call only.
  const ScanPhotograph* newest = nullptr;
};
using ScanListener = std::function<void(const ScanProgress&)>;

struct WallScan {
  solve::Measurements measurements;
  std::vector<ScanView> views;       ///< The views that the measurements consist of.
  std::vector<std::string> remarks;  ///< For the installer.
  int pictures = 0;                  ///< Number of photographs, including those of a resumed scan.
  int retries = 0;                   ///< Views that were measured again because somebody was in the way.
};

/// Scans the wall. On return, also after an error, all projectors are dark, and `folder` holds the views measured so
/// far, so that a call with ScanSettings::resume can continue. Errors: kUnavailable if `stop` was requested, if a
/// device is gone (plug it in, and resume), or if a projector lights nothing in any view; otherwise those of
/// plan_scan(), ScanFolder, measure_view() and Turntable. Blocks for minutes.
Result<WallScan> scan_wall(const Installation& installation, const ScanSettings& settings, const ScanDevices& devices,
                           const std::filesystem::path& folder, const ScanListener& listener, std::stop_token stop);

}  // namespace cyclorama::scan
