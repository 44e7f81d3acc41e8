// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "appliance/interchange/warp_set.h"

namespace cyclorama::interchange {

/// Returns whether the sample's first two numbers are finite; the third number of a flat map has no meaning and may be
/// NaN.
[[nodiscard]] bool is_mapped(const float* sample);

/// Samples a map at `x` to the right and `y` DOWN over the region, 0 to 1. Interpolates four samples bilinearly, and
/// extrapolates beyond the outermost samples. If one of the four is not mapped, returns the nearest of them; nothing if
/// the nearest is not mapped either.
[[nodiscard]] std::optional<Eigen::Vector3d> sample_map(const WarpMap& map, double x, double y);

/// Returns a mask's light at `x`, `y`, interpolated bilinearly; the outermost pixels extend to the edge.
[[nodiscard]] double sample_light(const MaskMap& mask, double x, double y);

}  // namespace cyclorama::interchange
