// SPDX-License-Identifier: Apache-2.0
/// Standard video timings, to which an EDID refers by number.
#pragma once

#include <cstdlib>
#include <optional>
#include <span>

#include "common/edid/video_timing.h"

namespace cyclorama {

/// Returns the timing of VESA's DMT id; nothing if there is no progressive one.
[[nodiscard]] std::optional<VideoTiming> dmt_timing(int id);
/// Returns VESA's timing of this size at this rate, rounded, with the blanking of cathode ray tubes.
[[nodiscard]] std::optional<VideoTiming> dmt_timing(int width_px, int height_px, int refresh_hz);
/// Returns the timing of a video identification code of CTA-861; nothing for those with repeated pixels.
[[nodiscard]] std::optional<VideoTiming> cta_timing(int vic);

}  // namespace cyclorama
