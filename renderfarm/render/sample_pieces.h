// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>

#include "renderfarm/render/quality.h"

namespace cyclorama::render {

/// Returns how many samples per pixel may be rendered at once so that a cell of 16x16 pixels takes some milliseconds,
/// in which it cannot be interrupted: a power of two from 1 to 32. All samples if they depend on each other: with
/// adaptive sampling or stored light.
[[nodiscard]] inline int max_samples_per_piece(const RenderQuality& quality) {
  constexpr int kMaxSegments = 32;  // Limit for the paths of one pixel.
  if (quality.adaptive_error > 0.0f || quality.stored_light) return quality.samples;
  return static_cast<int>(std::bit_floor(static_cast<unsigned>(std::max(1, kMaxSegments / (1 + quality.bounces)))));
}

}  // namespace cyclorama::render
