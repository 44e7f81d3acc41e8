// SPDX-License-Identifier: Apache-2.0
/// Functions with which importers keep Model's invariants for any file.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Magnitude, in the file's unit, from which coordinates count as not finite, because their squares would overflow in
/// float.
inline constexpr double kMaxCoordinate = 1e15;

[[nodiscard]] inline bool is_usable(const Eigen::Vector3d& p) { return (p.array().abs() < kMaxCoordinate).all(); }

/// Returns the origin for a mesh with corner `p`: zero if `p` is near the file's origin, so that the file's numbers are
/// kept; otherwise `p` in whole units.
[[nodiscard]] inline Eigen::Vector3d origin_near(const Eigen::Vector3d& p) {
  constexpr double kNear = 100.0;  // Within this distance, float has steps below 0.01 mm if the unit is the metre.
  return (p.array().abs() < kNear).all() ? Eigen::Vector3d::Zero().eval() : p.array().floor().matrix().eval();
}

/// Returns `value` rounded and clamped to [0, 255]; 0 for NaN.
[[nodiscard]] inline std::uint8_t to_byte(double value) {
  return value > 0.0 ? static_cast<std::uint8_t>(std::min(value, 255.0) + 0.5) : std::uint8_t{0};
}

/// Returns a texture coordinate or part of a normal as float; 0 if it is not usable.
[[nodiscard]] inline float finite_float(double value) {
  return std::abs(value) < kMaxCoordinate ? static_cast<float>(value) : 0.0f;
}

/// Makes every normal unit length; a normal that is zero or not finite becomes the mean of its triangles' normals.
/// Precondition: there are as many normals as positions, and indices are in range. Reentrant.
void repair_normals(Mesh* mesh);

}  // namespace cyclorama::scene
