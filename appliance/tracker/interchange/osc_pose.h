// SPDX-License-Identifier: Apache-2.0
/// The house's addresses in OSC, sent by cyclorama-tracker --osc and read by cyclorama-hand --osc:
///
///   /cyclorama/pose   i sensor  h sequence  h time_ns  d x y z (metres)  d qw qx qy qz
///   /cyclorama/lost   i sensor  h sequence  h time_ns
///   /cyclorama/steer  forward right turn, each -1 to 1                    from a telephone's sliders, say
///
/// Numbers of any type are read; what is missing, more, or at another address is not ours and is passed over.
#pragma once

#include <array>
#include <optional>

#include "appliance/tracker/interchange/osc.h"
#include "appliance/tracker/interchange/pose_report.h"

namespace cyclorama::tracker {

[[nodiscard]] OscMessage to_osc(const PoseReport& report);
[[nodiscard]] std::optional<PoseReport> pose_from_osc(const OscMessage& message);
/// Forward, right, turn; within [-1, 1].
[[nodiscard]] std::optional<std::array<double, 3>> steer_from_osc(const OscMessage& message);

}  // namespace cyclorama::tracker
