// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

namespace cyclorama::scan {

/// Inverse distance of the wall along a unit vector from the sweet spot, in 1/m; 0 or less where there is no wall.
using InverseDepthAt = std::function<double(const Eigen::Vector3d&)>;

/// Returns the direction in which the sweet spot sees the point where a ray from `centre_m` along `along` meets the
/// wall (Eye frame; `along` of any length). Returns nothing if the ray misses the wall or begins behind it. Reentrant.
[[nodiscard]] std::optional<Eigen::Vector3d> wall_direction_from(const Eigen::Vector3d& centre_m,
                                                                 const Eigen::Vector3d& along,
                                                                 const InverseDepthAt& inverse_depth);

}  // namespace cyclorama::scan
