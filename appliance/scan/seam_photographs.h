// SPDX-License-Identifier: Apache-2.0
/// The seams as a visitor will see them, before and after: photographs for the installer.
///
///     for each two projectors that meet:  turn to the middle of what both light
///         ─▶ lines by the old calibration, by the new one; white likewise ─▶ four photographs
#pragma once

#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "appliance/calibration/colour_file.h"
#include "appliance/scan/report_page.h"
#include "appliance/scan/wall_scan.h"

namespace cyclorama::scan {

/// What the wall is drawn by. Colours may be none; then the projectors are blended by their maps.
struct DrawnBy {
  std::string when;  ///< "by the calibration of ...", for captions.
  const calibration::Calibration* calibration =
      nullptr;  ///< Null: by installation.toml alone, as before any calibration.
  std::span<const calibration::CalibratedColour> colours{};
};

struct SeamPhotographs {
  std::vector<ReportFindings::Photograph> photographs;  ///< By seam: lines before, after, white before, after.
  int pictures = 0;
};

/// `after` has a calibration; `exposure_s` is one at which a single projector's white is not clipped. Whatever happens,
/// no pattern is left on the wall. Errors as take_photograph(), PatternScreen and Turntable. Blocks, for some seconds.
Result<SeamPhotographs> photograph_seams(const Installation& installation, const DrawnBy& before, const DrawnBy& after,
                                         double exposure_s, const ScanDevices& devices, const ScanListener& listener,
                                         std::stop_token stop);

}  // namespace cyclorama::scan
