// SPDX-License-Identifier: Apache-2.0
/// The colours that every projector of a wall can make.
///
///      G          each projector's primaries are a triangle in the plane of chromaticities; all can make what lies in
///     ╱╲╲         all triangles: a convex polygon. The largest triangle inside a convex polygon has its corners at
///    ╱──╲╲        corners of the polygon, so trying all threes of them finds it.
///   B────R╲
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::photometry {

struct CommonGamut {
  Eigen::Matrix3d wall;  ///< Columns: red, green, blue that all can make; they add up to a white of luminance 1.
  /// Per projector: from the wall's red, green, blue to its own, and no row adds up to more than 1.
  std::vector<Eigen::Matrix3d> matrices;
  /// Per projector: the luminance that its brightest wall white keeps of its own white's.
  std::vector<double> kept;
  double area_kept = 1.0;  ///< Of the smallest projector's triangle.
};

/// `primaries`: columns are a projector's red, green and blue in the camera's linear colours; `luminance` weighs these.
/// The white is the one that costs the worst-off projector least.
/// kBadData  a projector's primaries have no triangle, or the triangles have nothing in common: says which. Reentrant.
Result<CommonGamut> common_gamut(std::span<const Eigen::Matrix3d> primaries, const Eigen::Vector3d& luminance,
                                 std::span<const std::string> names);

}  // namespace cyclorama::photometry
