// SPDX-License-Identifier: Apache-2.0
/// Shared by importers so that Model's invariants hold for any file.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Coordinates beyond this, in the file's unit, count as not finite: their squares would overflow in float.
inline constexpr double kMaxCoordinate = 1e15;

[[nodiscard]] inline bool is_usable(const Eigen::Vector3d& p) { return (p.array().abs() < kMaxCoordinate).all(); }

/// Returns the origin for a mesh with corner `p`: zero near the file's own origin, so that the file's numbers are kept;
/// otherwise whole units near `p`.
[[nodiscard]] inline Eigen::Vector3d origin_near(const Eigen::Vector3d& p) {
  constexpr double kNear = 100.0;  // Within this distance a float has steps below 0.01 mm, if the unit is a metre.
  return (p.array().abs() < kNear).all() ? Eigen::Vector3d::Zero().eval() : p.array().floor().matrix().eval();
}

/// Rounds and clamps to 0 to 255; NaN gives 0.
[[nodiscard]] inline std::uint8_t to_byte(double value) {
  return value > 0.0 ? static_cast<std::uint8_t>(std::min(value, 255.0) + 0.5) : std::uint8_t{0};
}

/// For texture coordinates and normals: an unusable value becomes 0.
[[nodiscard]] inline float finite_float(double value) {
  return std::abs(value) < kMaxCoordinate ? static_cast<float>(value) : 0.0f;
}

/// Makes every normal unit length; a normal that is zero or not finite becomes the mean of its triangles' normals.
/// Precondition: as many normals as positions, indices in range. Reentrant.
void repair_normals(Mesh* mesh);

}  // namespace cyclorama::scene
