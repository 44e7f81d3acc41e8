// SPDX-License-Identifier: Apache-2.0
/// Converts a cloud of points, as from a laser scanner, to a surface of small squares.
#pragma once

#include <cstddef>

#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Bytes for each point during the conversion, in addition to the point itself.
inline constexpr std::size_t kSquareBytes = 4 * (12 + 4) + 24 + 32;

/// Replaces the points of `cloud`, which has no triangles, by squares that overlap a little. A square is in the plane
/// of the point's neighbours, or perpendicular to its normal if the cloud has normals; its side is about the distance
/// between points there. Colours are kept. Returns the median distance between neighbours. Takes about a microsecond
/// for each point. Precondition: there is at least one point, and memory of kSquareBytes for each. Reentrant.
double make_point_squares(Mesh* cloud);

}  // namespace cyclorama::scene
