// SPDX-License-Identifier: Apache-2.0
/// Which of a projector's modes to light it with. Pure.
#pragma once

#include <xf86drmMode.h>

#include <span>
#include <string>
#include <vector>

namespace cyclorama::output {

/// What the installation preferences; width and height as they leave the connector, before any rotation.
struct ModePreference {
  int width_px = 0;
  int height_px = 0;
  double refresh_hz = 60.0;
};

/// Exact, from pixel clock and totals; the kernel's own field is rounded. 0 for a mode without them.
[[nodiscard]] double refresh_hz_of(const drmModeModeInfo& mode);
/// "1920x1080@60.00", for people.
[[nodiscard]] std::string text_of(const drmModeModeInfo& mode);
[[nodiscard]] bool is_same_mode(const drmModeModeInfo& a, const drmModeModeInfo& b);

/// The modes worth trying, best first:
///   1. progressive ones of the requested size, nearest to the requested rate first;
///   2. what the projector prefers (its panel's own size: the picture is scaled to it);
///   3. other progressive ones, largest first;
///   4. 1024x768 at 60 Hz, which every projector takes: for one whose EDID could not be read.
/// Interlaced, doubled, 3D and impossible modes are left out. Never empty; no mode twice; at most 8.
[[nodiscard]] std::vector<drmModeModeInfo> modes_to_try(std::span<const drmModeModeInfo> offered,
                                                        const ModePreference& preferred);

}  // namespace cyclorama::output
