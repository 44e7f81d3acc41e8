// SPDX-License-Identifier: Apache-2.0
/// One room, moved away from the origin or scaled; its picture should not change.
#pragma once

#include <vector>

#include "common/base/result.h"

namespace cyclorama {

/// Maximum difference between pictures of the same room.
inline constexpr double kSameFlip = 0.01;

struct SamePicture {
  double metres = 0.0;  ///< Distance from the origin, or length of the room.
  double flip = 0.0;    ///< Compared with the room of 6 m at the origin.
};

/// The height is half of `width_px`; both sweeps render one picture for each entry of `metres`.
Result<std::vector<SamePicture>> far_from_the_origin(const std::vector<double>& metres, int width_px, int threads);
Result<std::vector<SamePicture>> scaled(const std::vector<double>& metres, int width_px, int threads);

}  // namespace cyclorama
