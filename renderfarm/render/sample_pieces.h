// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>

#include "renderfarm/render/quality.h"

namespace cyclorama::render {

/// Returns the number of samples per pixel to render without interruption, so that a cell of 16x16 pixels takes only
/// some milliseconds: a power of two from 1 to 64. With adaptive sampling or stored light, samples depend on each
/// other, so all of them are rendered at once.
[[nodiscard]] inline int max_samples_per_piece(const RenderQuality& quality) {
  constexpr int kMaxSegments = 64;  // Maximum number of path segments of one pixel.
  if (quality.adaptive_error > 0.0f || quality.stored_light) return quality.samples;
  return static_cast<int>(std::bit_floor(static_cast<unsigned>(std::max(1, kMaxSegments / (1 + quality.bounces)))));
}

}  // namespace cyclorama::render
