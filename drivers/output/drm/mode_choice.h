// SPDX-License-Identifier: Apache-2.0
/// Choice of a projector's mode. Pure.
#pragma once

#include <xf86drmMode.h>

#include <span>
#include <string>
#include <vector>

#include "common/edid/video_timing.h"

namespace cyclorama::output {

/// Mode that the installation requests; width and height are those of the signal, after any rotation.
struct ModePreference {
  int width_px = 0;
  int height_px = 0;
  double refresh_hz = 60.0;
};

/// Returns the exact rate from pixel clock and totals, since the kernel's own field is rounded; 0 for a mode without
/// them.
[[nodiscard]] double refresh_hz_of(const drmModeModeInfo& mode);
/// Returns a text for people, such as "1920x1080@60.00".
[[nodiscard]] std::string text_of(const drmModeModeInfo& mode);
[[nodiscard]] bool is_same_mode(const drmModeModeInfo& a, const drmModeModeInfo& b);

/// Converts timings of an EDID to modes.
[[nodiscard]] std::vector<drmModeModeInfo> modes_of(std::span<const VideoTiming> timings);

/// Returns the modes to try, best first:
///   1. progressive modes of the requested size, nearest to the requested rate first;
///   2. the projector's preferred mode (its panel's native size, to which the picture is scaled);
///   3. other progressive modes, largest first, one for each size;
///   4. interlaced modes, for projectors that have nothing else that the card can feed;
///   5. 1024x768 at 60 Hz, which every projector supports, in case the EDID could not be read.
/// Excludes doubled, 3D and invalid modes. Never empty; no duplicates; at most 32.
[[nodiscard]] std::vector<drmModeModeInfo> modes_to_try(std::span<const drmModeModeInfo> offered,
                                                        const ModePreference& preferred);

}  // namespace cyclorama::output
