// SPDX-License-Identifier: Apache-2.0
/// Shows a cloud of points, as laser scanners give it, as a surface of small squares.
#pragma once

#include <cstddef>

#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Memory for each point while its square is made, besides the point itself.
inline constexpr std::size_t kSquareBytes = 4 * (12 + 4) + 24 + 32;

/// Replaces the points of `cloud`, which has no triangles, by squares that overlap a little. A square lies in the plane
/// of the point's neighbours, or across its normal if the cloud has normals, and its side is about the distance between
/// points there. Keeps the colours. Returns the median distance between neighbours. Takes about a microsecond for each
/// point. Precondition: at least one point, and memory for kSquareBytes each. Reentrant.
double make_point_squares(Mesh* cloud);

}  // namespace cyclorama::scene
