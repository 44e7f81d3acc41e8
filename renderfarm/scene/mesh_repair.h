// SPDX-License-Identifier: Apache-2.0
/// What importers do alike, so that Model's invariants hold for whatever a file says.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "renderfarm/scene/model.h"

namespace cyclorama {

/// Positions beyond this (in units of the file) count as not finite: their squares would overflow in float.
inline constexpr double kFarthest = 1e15;

[[nodiscard]] inline bool is_usable(const Eigen::Vector3d& p) { return (p.array().abs() < kFarthest).all(); }

/// The origin for a mesh of which `p` is a corner: zero near the file's own origin, so that the file's numbers are
/// kept, else whole units near `p`.
[[nodiscard]] inline Eigen::Vector3d origin_near(const Eigen::Vector3d& p) {
  constexpr double kNear = 100.0;  // There a float still has steps below 0.01 mm, if the unit is a metre.
  return (p.array().abs() < kNear).all() ? Eigen::Vector3d::Zero().eval() : p.array().floor().matrix().eval();
}

/// 0 to 255, rounded; NaN gives 0.
[[nodiscard]] inline std::uint8_t to_byte(double value) {
  return value > 0.0 ? static_cast<std::uint8_t>(std::min(value, 255.0) + 0.5) : std::uint8_t{0};
}

/// For texture coordinates and normals: what is not usable becomes 0.
[[nodiscard]] inline float finite_float(double value) {
  return std::abs(value) < kFarthest ? static_cast<float>(value) : 0.0f;
}

/// Makes every normal unit length; one that is zero or not finite becomes the mean of its triangles' normals.
/// Precondition: as many normals as positions, indices in range. Reentrant.
void repair_normals(Mesh* mesh);

}  // namespace cyclorama
