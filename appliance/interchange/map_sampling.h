// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "appliance/interchange/warp_set.h"

namespace cyclorama::interchange {

/// Of a flat map the third number says nothing and may be NaN.
[[nodiscard]] bool is_mapped(const float* sample);

/// A map between its samples: `x` to the right and `y` DOWN over the region, 0 to 1. Straight between four samples and
/// beyond the outermost ones; the nearest sample where one of the four is not mapped; nothing where that is not either.
[[nodiscard]] std::optional<Eigen::Vector3d> sample_map(const WarpMap& map, double x, double y);

/// A mask's light between its pixels, likewise; the outermost pixels go on.
[[nodiscard]] double sample_light(const MaskMap& mask, double x, double y);

}  // namespace cyclorama::interchange
