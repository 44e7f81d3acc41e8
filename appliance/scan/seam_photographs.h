// SPDX-License-Identifier: Apache-2.0
/// Photographs of the seams, for the installer, before and after a calibration.
///
///     for each pair of projectors that meet:  turn to the middle of their overlap
///         ─▶ lines and white, each drawn by the old calibration, then by the new one ─▶ four photographs
#pragma once

#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "appliance/calibration/colour_file.h"
#include "appliance/scan/report_page.h"
#include "appliance/scan/wall_scan.h"

namespace cyclorama::scan {

/// Calibration and colours with which the heads are drawn. Without colours, the blend follows from the maps.
struct DrawnBy {
  std::string when;                                       ///< For captions: "by the calibration of ...".
  const calibration::Calibration* calibration = nullptr;  ///< Null: drawn by installation.toml alone.
  std::span<const calibration::CalibratedColour> colours{};
};

struct SeamPhotographs {
  /// Per seam: lines before, lines after, white before, white after.
  std::vector<ReportFindings::Photograph> photographs;
  int pictures = 0;
};

/// Photographs all seams. `after` must have a calibration; `exposure_s` is an exposure at which a single projector's
/// white is not clipped. On return, also after an error, all projectors are dark. Errors: those of take_photograph(),
/// PatternScreen and Turntable. Blocks for some seconds.
Result<SeamPhotographs> photograph_seams(const Installation& installation, const DrawnBy& before, const DrawnBy& after,
                                         double exposure_s, const ScanDevices& devices, const ScanListener& listener,
                                         std::stop_token stop);

}  // namespace cyclorama::scan
