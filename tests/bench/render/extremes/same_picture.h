// SPDX-License-Identifier: Apache-2.0
/// One room, moved away from the origin or made larger and smaller: its picture should not know.
#pragma once

#include <vector>

#include "common/base/result.h"

namespace cyclorama {

/// The most that pictures of the same may differ by.
inline constexpr double kSameFlip = 0.01;

struct SamePicture {
  double metres = 0.0;  ///< The distance from the origin, or the room's length.
  double flip = 0.0;    ///< Against the room of 6 m at the origin.
};

/// `width_px` is twice the height; both sweeps render one picture for each of the metres.
Result<std::vector<SamePicture>> far_from_the_origin(const std::vector<double>& metres, int width_px, int threads);
Result<std::vector<SamePicture>> scaled(const std::vector<double>& metres, int width_px, int threads);

}  // namespace cyclorama
