// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

namespace cyclorama {

/// How near the wall is along a unit vector from the sweet spot, in 1/m; 0 or less where there is none.
using NearnessAt = std::function<double(const Eigen::Vector3d&)>;

/// Where the sweet spot sees what a line of sight, or of light, ends on: from `centre_m` along `along` (Eye frame; the
/// latter of any length). Nothing where it misses the wall, or begins behind it. Reentrant.
[[nodiscard]] std::optional<Eigen::Vector3d> seen_end(const Eigen::Vector3d& centre_m, const Eigen::Vector3d& along,
                                                      const NearnessAt& nearness);

}  // namespace cyclorama
