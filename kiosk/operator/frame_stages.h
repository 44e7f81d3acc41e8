// SPDX-License-Identifier: Apache-2.0
/// The stages of a frame from shutter to photon, in order: docs/reference/frame-timing.md.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "common/wire/inspection.pb.h"

namespace cyclorama::operations {

/// A stage. `inside` names the stage that contains it, or is empty. A containing stage comes before its parts.
struct FrameStage {
  std::string_view name;
  std::string_view where;  ///< "tracker", "tour", "farm", "display", "whole".
  std::string_view inside;
};

inline constexpr std::array<FrameStage, 16> kFrameStages{{
    {"capture", "tracker", ""},
    {"detect", "tracker", ""},
    {"pose", "tracker", ""},
    {"steer", "tour", ""},
    {"farm_round_trip", "farm", ""},
    {"farm", "farm", "farm_round_trip"},
    {"queue", "farm", "farm"},
    {"plan", "farm", "farm"},
    {"fan_out", "farm", "farm"},
    {"render", "farm", "farm"},
    {"encode", "farm", "farm"},
    {"decode", "display", ""},
    {"wait", "display", ""},
    {"draw", "display", ""},
    {"heading_to_photon", "whole", ""},
    {"shutter_to_photon", "whole", ""},
}};

/// Returns the tour's stages in the order above; unknown stages come last, in the tour's order.
[[nodiscard]] std::vector<wire::Stage> in_frame_order(const wire::ProcessStatus& tour);

}  // namespace cyclorama::operations
