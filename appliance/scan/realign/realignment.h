// SPDX-License-Identifier: Apache-2.0
/// One projector that somebody pushed, put back into the picture within seconds, by the calibration that exists:
///
///     turn to it ─▶ its own patterns, coarse ones only ─┐
///                └▶ sines on all others at once ─▶ find_stand(): where the camera stands now
///                                                       ▼
///                directions of its pixels ─▶ find_push(): pushed? lens turned? ─▶ its new map, checked by what was
///                                                       │                         left out of it
///                                                       ▼
///                        masks and colours of all by the light that was measured before ─▶ another calibration
#pragma once

#include "appliance/scan/calibration_run.h"

namespace cyclorama {

/// How a realignment went, beside what any calibration tells.
struct RealignmentOutcome {
  /// As run_calibration()'s. Its registration is of the pushed projector and those beside it, of places that its map
  /// was not fitted to. Where nothing has moved it is the calibration of before, and none was written.
  CalibrationOutcome outcome;
  MeasuredRegistration before;  ///< With its map of before, of the same places.
  bool has_moved = false;
  double turned_rad = 0.0;  ///< What it was pushed by.
  double moved_m = 0.0;
  double explained_px = 0.0;    ///< What such a push leaves of what is seen, per axis.
  double camera_moved_m = 0.0;  ///< Where the camera stands other than it stood; 0 where that is not clear.
  double seen_fraction = 0.0;   ///< Of its map: measured; the rest follows from the push.
  bool has_colours = false;     ///< Masks and colours follow the new map.
};

/// All other projectors must stand as they were calibrated, and the camera about where it stood (a quarter of a degree
/// beyond what the plate errs by, some centimetres). A worse map than before is never taken.
/// kNotFound  no calibration is there, or it has no such projector.
/// kBadData   its lens was turned, what it shows is not explained by a push, others have moved too, the camera is
///            another one or stands elsewhere, it meets no other projector any more, or the calibration lacks what is
///            needed (the wall, the light): each says so, and to calibrate all of them.
/// kUnavailable  it is dark; or cancelled.   Others as measure_view() and Turnplate. Blocks, for some ten seconds.
Result<RealignmentOutcome> realign_projector(const Installation& installation, const std::string& projector,
                                             const ScanSettings& settings, const ScanDevices& devices,
                                             const std::filesystem::path& folder, const std::string& date,
                                             const Clock& clock, const ScanListener& listener, std::stop_token stop);

}  // namespace cyclorama
