// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

#include "appliance/display/frame_assembler.h"

namespace cyclorama {

/// Heads that show all of any panorama, so that every tile is decoded.
inline display::ShownByHeads heads_that_see_all() {
  constexpr int kRows = 1024;
  warp::PixelMap map(2, kRows);
  for (int y = 0; y < kRows; ++y) {
    const float tan_elevation = 2.0f - 4.0f * static_cast<float>(y) / kRows;
    map.at(0, y)[0] = -std::numbers::pi_v<float>;
    map.at(1, y)[0] = std::numbers::pi_v<float>;
    for (const int x : {0, 1}) map.at(x, y)[1] = tan_elevation;
  }
  return {{display::HeadFootprint(map, warp::MaskImage(2, kRows, 1.0f))},
          Panorama{16, 16, 2.0 * std::numbers::pi, 2.0, -2.0}};
}

}  // namespace cyclorama
