// SPDX-License-Identifier: Apache-2.0
/// What importers do alike, so that Model's invariants hold for whatever a file says.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "renderfarm/scene/model.h"

namespace cyclorama {

/// Positions beyond this (in units of the file) count as not finite: their squares would overflow in float.
inline constexpr double kFarthest = 1e15;

[[nodiscard]] inline bool is_usable(const Eigen::Vector3d& p) { return (p.array().abs() < kFarthest).all(); }

/// Makes every normal unit length; one that is zero or not finite becomes the mean of its triangles' normals.
/// Precondition: as many normals as positions, indices in range. Reentrant.
void repair_normals(Mesh* mesh);

}  // namespace cyclorama
