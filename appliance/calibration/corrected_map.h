// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "appliance/calibration/measured_map.h"
#include "appliance/calibration/show_file.h"
#include "common/room/wall.h"

namespace cyclorama::calibration {

/// Returns the approximate RMS displacement of a projector's pixels by its correction, over its picture, in projector
/// pixels. Pixels that miss the wall do not count.
[[nodiscard]] double moved_px(const ShowFile::Projector& projector, const Wall& wall);

/// Adapts a measured map to the projector's present pose. The model (wall, lens, the two poses) predicts how far each
/// control point's direction turned, and the measured direction is turned by that, so deviations of wall and lens from
/// the model remain as measured.
///
///     pixel ─▶ wall, from the scanned pose ─▶ direction d      turn(d → d') · measured direction
///          └─▶ wall, from the applied pose ─▶ direction d' ────┘
///
/// Control points that the model cannot place lose their direction. The map of a projector that did not move is
/// bit-identical. `sweet_spot`: the origin of the map's directions. Reentrant.
[[nodiscard]] MeasuredMap corrected_map(const MeasuredMap& map, const ShowFile::Projector& projector, const Wall& wall,
                                        const Point<frame::Room>& sweet_spot);

}  // namespace cyclorama::calibration
