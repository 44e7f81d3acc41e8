// SPDX-License-Identifier: Apache-2.0
/// The scan of the whole wall: turns the turntable, lights one projector after the other, and keeps what was seen.
///
///     for each direction:  turn ─▶ for each projector that is seen from here:  measure_view() ─▶ ScanFolder
///                                        ▲ once more, when somebody walked through │
///                                        └──────────────────────────────────────────┘
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

/// What a scan holds while it works. Borrows them all.
struct ScanDevices {
  PatternScreen& screen;
  ScanCamera& camera;
  turntable::Turntable& turntable;
  /// The same camera with its colour filters, where `camera` is without: brightness and colour are measured with it.
  ScanCamera* colour_camera = nullptr;
};

struct ScanSettings {
  calibration::MeasuredLens camera;   ///< With the covariance of its own calibration, or of a data sheet.
  double pitch_rad = 0.0;             ///< How far it looks up, about.
  double turntable_sigma_rad = 1e-3;  ///< How far the turntable's angles may be wrong.
  ViewSettings view{};
  int directions = 0;           ///< As ScanPlanOptions'.
  double max_disturbed = 0.02;  ///< Of the lit pixels; with more the view is measured once more.
  bool resume = false;
  bool with_seams = true;  ///< Photograph them for the report: some seconds.
  bool with_wall = true;   ///< Find out its shape too, for eyes off the sweet spot: most of the time of solving.
};

/// Turns there; a turntable that stalled has forgotten where it stands, and is homed and asked once more. Errors as
/// Turntable's.
Status turn_with_retry(turntable::Turntable& turntable, double angle_rad);

/// A lens of which one knows the field of view, as its data sheet has it, and no more: the directions of the turntable
/// teach the rest.
[[nodiscard]] calibration::MeasuredLens data_sheet_lens(int width_px, int height_px, double field_of_view_rad);

struct ScanProgress {
  std::string step;       ///< One sentence for people.
  double fraction = 0.0;  ///< Of the scan, 0 to 1; never falls.
  /// Null between photographs. Lives for the call.
  const ScanPhotograph* newest = nullptr;
};
using ScanListener = std::function<void(const ScanProgress&)>;

struct WallScan {
  solve::Measurements measurements;
  std::vector<ScanView> views;       ///< What the measurements were made of.
  std::vector<std::string> remarks;  ///< For the installer.
  int pictures = 0;                  ///< Photographs, of this scan and of those that it went on with.
  int retries = 0;                   ///< Views that were measured again, because somebody was in the way.
};

/// Whatever happens, no pattern is left on the wall. A turntable that stalls is homed and asked once more. What was
/// measured is in `folder` when it returns, with an error too: with ScanSettings::resume another call goes on there.
/// kUnavailable  cancelled, or a device is gone: plug it in, and resume; or a projector lights nothing anywhere.
/// Others as plan_scan(), ScanFolder, measure_view() and Turntable. Blocks, for minutes.
Result<WallScan> scan_wall(const Installation& installation, const ScanSettings& settings, const ScanDevices& devices,
                           const std::filesystem::path& folder, const ScanListener& listener, std::stop_token stop);

}  // namespace cyclorama::scan
