// SPDX-License-Identifier: Apache-2.0
/// Realigns one displaced projector within seconds, using the existing calibration:
///
///     read_baseline()         the previous calibration and the projectors that serve as references
///           ▼
///     photograph_displaced()  the projector's own patterns (coarse ones only), then sines on all references at once
///           ▼
///     find_new_map()          the camera's pose from the references, the displacement, a map tested on left-out blocks
///           ▼
///     follow_light()          masks and colours of all projectors from the light that was measured before
///           ▼
///     save_calibration()      a new calibration
#pragma once

#include "appliance/scan/calibration_run.h"

namespace cyclorama::scan {

/// Result of a realignment.
struct RealignmentOutcome {
  /// Outcome as of run_calibration(). The registration is that of the displaced projector and its neighbours, over
  /// correspondences to which its map was not fitted. If nothing has moved, the calibration is the previous one, and
  /// none was written.
  CalibrationOutcome outcome;
  solve::MeasuredRegistration before;  ///< Registration over the same correspondences, with the projector's previous
                                       ///< map.
  bool has_moved = false;
  double turned_rad = 0.0;  ///< Rotation of the displacement.
  double moved_m = 0.0;
  double explained_px = 0.0;    ///< RMS residual per axis of the displacement.
  double camera_moved_m = 0.0;  ///< Distance of the camera from its calibrated position; 0 if not significant.
  double seen_fraction = 0.0;   ///< Measured fraction of the map; the displacement gives the rest.
  bool has_colours = false;     ///< True if masks and colours were carried over to the new map.
};

/// Measures a displaced projector anew and saves a new calibration. Preconditions: all other projectors have their
/// calibrated poses, and the camera stands about where it stood during the calibration (to within a quarter of a degree
/// beyond the turntable's error, and some centimetres). A map worse than the previous one is never taken. Errors:
/// kNotFound if there is no calibration or it lacks that projector; kBadData, with the advice to calibrate all
/// projectors, if the lens was turned, no displacement explains the observations, other projectors have moved too, the
/// camera is a different one or stands elsewhere, the projector no longer overlaps another, or the calibration lacks
/// what is needed (wall, light); kUnavailable if the projector is dark or `stop` was requested; otherwise those of
/// measure_view() and Turntable. Blocks for about ten seconds.
Result<RealignmentOutcome> realign_projector(const Installation& installation, const std::string& projector,
                                             const ScanSettings& settings, const ScanDevices& devices,
                                             const std::filesystem::path& folder, const std::string& date,
                                             const Clock& clock, const ScanListener& listener, std::stop_token stop);

}  // namespace cyclorama::scan
