// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "appliance/calibration/measured_map.h"
#include "appliance/calibration/show_file.h"
#include "common/room/wall.h"

namespace cyclorama::calibration {

/// How far a correction moves a projector's pixels, about: root mean square over its picture, in its pixels. What does
/// not meet the wall does not count.
[[nodiscard]] double moved_px(const ShowFile::Projector& projector, const Wall& wall);

/// What was measured of a projector, for where it stands now. The model (wall, lens, the two poses) says by how much
/// each control point's direction turned, and the measured one is turned by that: what the model does not know, of the
/// wall or of the lens, stays as it was measured.
///
///     pixel ─▶ wall, from the scanned pose ─▶ direction d      turn(d → d') · measured direction
///          └─▶ wall, from the applied pose ─▶ direction d' ────┘
///
/// Control points for which the model has no place lose their direction. A projector that did not move keeps its map to
/// the bit. `sweet_spot`: the origin of the map's directions. Reentrant.
[[nodiscard]] MeasuredMap corrected_map(const MeasuredMap& map, const ShowFile::Projector& projector, const Wall& wall,
                                        const Point<frame::Room>& sweet_spot);

}  // namespace cyclorama::calibration
