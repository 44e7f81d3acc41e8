// SPDX-License-Identifier: Apache-2.0
#include "appliance/tags/straight_corners.h"

#include <Eigen/LU>

namespace cyclorama::tags {

std::vector<TagDetection> straightened(const std::vector<TagDetection>& seen, const calibration::BrownLens& lens,
                                       const Pinhole& straight) {
  std::vector<TagDetection> result;
  for (TagDetection tag : seen) {
    bool is_whole = true;
    for (std::size_t i = 0; i < tag.corners.size() && is_whole; ++i) {
      const calibration::SlopeAnswer answer = lens.slope_at(tag.corners[i]);
      const auto pixel = answer ? straight.pixel_of({answer.slope.x(), answer.slope.y(), 1.0}) : std::nullopt;
      is_whole = pixel.has_value();
      if (!is_whole) break;
      const Eigen::Matrix2d stretched = straight.focal_px * lens.jacobian(answer.slope).inverse();
      tag.corners[i] = *pixel;
      tag.covariance[i] = stretched * tag.covariance[i] * stretched.transpose();
    }
    if (is_whole) result.push_back(tag);
  }
  return result;
}

}  // namespace cyclorama::tags
