// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "appliance/calibration/measured_map.h"
#include "appliance/calibration/show_file.h"
#include "common/room/wall.h"

namespace cyclorama::calibration {

/// Returns the approximate RMS displacement of a projector's pixels by its correction, over its picture, in projector
/// pixels. Pixels that miss the wall are ignored.
[[nodiscard]] double moved_px(const ShowFile::Projector& projector, const Wall& wall);

/// Adapts a measured map to the projector's present pose. The model (wall, lens, and the two poses) predicts the
/// rotation of each control point's direction, and the measured direction is rotated by it, so deviations of wall and
/// lens from the model remain as measured.
///
///     pixel ─▶ wall, from the scanned pose ─▶ direction d      turn(d → d') · measured direction
///          └─▶ wall, from the applied pose ─▶ direction d' ────┘
///
/// Control points for which the model has no prediction lose their direction. The map of a projector that did not move
/// is bit-identical. `sweet_spot`: the origin of the map's directions. Reentrant.
[[nodiscard]] MeasuredMap corrected_map(const MeasuredMap& map, const ShowFile::Projector& projector, const Wall& wall,
                                        const Point<frame::Room>& sweet_spot);

}  // namespace cyclorama::calibration
