// SPDX-License-Identifier: Apache-2.0
/// The colour gamut that all projectors of a wall have in common.
///
///      G          each projector's primaries form a triangle in the chromaticity plane; the common gamut is the
///     ╱╲╲         intersection of the triangles, a convex polygon. The largest triangle inside a convex polygon has
///    ╱──╲╲        its corners at corners of the polygon, so an exhaustive search over triples finds it.
///   B────R╲
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::photometry {

struct CommonGamut {
  Eigen::Matrix3d wall;  ///< Columns: the common red, green and blue, whose sum has luminance 1.
  /// Per projector: matrix from the common primaries to the projector's; no row adds up to more than 1.
  std::vector<Eigen::Matrix3d> matrices;
  /// Per projector: luminance of its brightest common white relative to that of its native white.
  std::vector<double> kept;
  double area_kept = 1.0;  ///< Area of the common triangle relative to that of the smallest projector triangle.
};

/// Computes the common gamut. The columns of `primaries` are a projector's red, green and blue in the camera's linear
/// colours; `luminance` weights these channels. The common white is chosen so that the largest loss of luminance of any
/// projector is smallest. Errors: kBadData, with the projector's name, if its primaries do not form a triangle or the
/// triangles do not intersect. Reentrant.
Result<CommonGamut> common_gamut(std::span<const Eigen::Matrix3d> primaries, const Eigen::Vector3d& luminance,
                                 std::span<const std::string> names);

}  // namespace cyclorama::photometry
