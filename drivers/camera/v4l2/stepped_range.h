// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace cyclorama::camera {

/// Returns the value of `min`, `min` + `step`, ... up to `max` that is nearest to `wanted`. A device may report a step
/// of 0, or a range that ends before it begins: then only `min` is possible.
[[nodiscard]] constexpr long nearest_step(long min, long max, long step, long wanted) {
  const long width = std::max(step, 1L);
  const long last = (std::max(min, max) - min) / width;
  const long steps = (std::clamp(wanted, min, std::max(min, max)) - min + width / 2) / width;
  return min + std::min(steps, last) * width;
}

}  // namespace cyclorama::camera
