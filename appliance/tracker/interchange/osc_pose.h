// SPDX-License-Identifier: Apache-2.0
/// Cyclorama's addresses in OSC, sent by cyclorama-tracker --osc and read by cyclorama-hand --osc:
///
///   /cyclorama/pose   i sensor  h sequence  h time_ns  d x y z (metres)  d qw qx qy qz
///   /cyclorama/lost   i sensor  h sequence  h time_ns
///   /cyclorama/steer  forward right turn, each -1 to 1                    for example from sliders on a telephone
///   /cyclorama/stop   1, -1 or a name                                     the next, previous or named stop of the tour
///   /cyclorama/captions  1, or no, one or two languages' tags             written on the wall; 1 is the next language
///
/// Numbers of any type are accepted; messages with missing or additional arguments, or with another address, are
/// ignored.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "appliance/tracker/interchange/osc.h"
#include "appliance/tracker/interchange/pose_report.h"

namespace cyclorama::tracker {

[[nodiscard]] OscMessage to_osc(const PoseReport& report);
[[nodiscard]] std::optional<PoseReport> pose_from_osc(const OscMessage& message);
/// The number of stops to go on, 1 or -1, or a stop's name.
using OscStop = std::variant<int, std::string>;
[[nodiscard]] std::optional<OscStop> stop_from_osc(const OscMessage& message);
/// Languages to be written on the wall; nothing for the next one.
struct OscCaptions {
  std::optional<std::vector<std::string>> languages;
  friend bool operator==(const OscCaptions&, const OscCaptions&) = default;
};
[[nodiscard]] std::optional<OscCaptions> captions_from_osc(const OscMessage& message);
/// Returns forward, right, turn; clamped to [-1, 1].
[[nodiscard]] std::optional<std::array<double, 3>> steer_from_osc(const OscMessage& message);

}  // namespace cyclorama::tracker
