// SPDX-License-Identifier: Apache-2.0
/// One projector that somebody displaced, put back into the picture within seconds, by the calibration that exists:
///
///     read_baseline()         the calibration of before, and the projectors that serve as references
///           ▼
///     photograph_displaced()  the projector's own patterns, coarse ones only, then sines on all references at once
///           ▼
///     find_new_map()          the camera's pose by the references, the displacement, a map checked by left-out blocks
///           ▼
///     follow_light()          masks and colours of all projectors by the light that was measured before
///           ▼
///     save_calibration()      another calibration
#pragma once

#include "appliance/scan/calibration_run.h"

namespace cyclorama::scan {

/// The result of a realignment, beside that of any calibration.
struct RealignmentOutcome {
  /// Like that of run_calibration(). Its registration is that of the displaced projector and its neighbours, over places that
  /// its map was not fitted to. If nothing has moved, it is the calibration of before, and none was written.
  CalibrationOutcome outcome;
  solve::MeasuredRegistration before;  ///< The same with the projector's map of before.
  bool has_moved = false;
  double turned_rad = 0.0;  ///< The displacement's rotation and translation.
  double moved_m = 0.0;
  double explained_px = 0.0;    ///< RMS per axis of what the displacement leaves unexplained.
  double camera_moved_m = 0.0;  ///< Distance of the camera from where it stood; 0 where that is not clear.
  double seen_fraction = 0.0;   ///< Part of the map that was measured; the rest follows from the displacement.
  bool has_colours = false;     ///< Masks and colours follow the new map.
};

/// All other projectors must stand as they were calibrated, and the camera about where it stood (a quarter of a degree
/// beyond what the turntable errs by, some centimetres). A worse map than before is never taken.
/// kNotFound  no calibration is there, or it has no such projector.
/// kBadData   its lens was turned, what it shows is not explained by a push, others have moved too, the camera is
///            another one or stands elsewhere, it meets no other projector any more, or the calibration lacks what is
///            needed (the wall, the light): each says so, and to calibrate all of them.
/// kUnavailable  it is dark; or cancelled.   Others as measure_view() and Turntable. Blocks, for some ten seconds.
Result<RealignmentOutcome> realign_projector(const Installation& installation, const std::string& projector,
                                             const ScanSettings& settings, const ScanDevices& devices,
                                             const std::filesystem::path& folder, const std::string& date,
                                             const Clock& clock, const ScanListener& listener, std::stop_token stop);

}  // namespace cyclorama::scan
