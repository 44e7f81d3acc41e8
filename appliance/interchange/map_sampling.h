// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "appliance/interchange/warp_set.h"

namespace cyclorama::interchange {

/// Returns whether the sample's first two numbers are finite; the third one of a flat map has no meaning and may be
/// NaN.
[[nodiscard]] bool is_mapped(const float* sample);

/// Samples a map at `x` to the right and `y` DOWN over the region, 0 to 1. Bilinear between four samples and beyond the
/// outermost ones; the nearest sample if one of the four is not mapped; empty if that one is not either.
[[nodiscard]] std::optional<Eigen::Vector3d> sample_map(const WarpMap& map, double x, double y);

/// Samples a mask's light in the same way; the outermost pixels extend to the edge.
[[nodiscard]] double sample_light(const MaskMap& mask, double x, double y);

}  // namespace cyclorama::interchange
