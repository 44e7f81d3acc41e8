// SPDX-License-Identifier: Apache-2.0
/// The picture that a head shows of a test picture, computed pixel by pixel as the display would draw it through the
/// warp.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "appliance/warp/blend_mask.h"
#include "appliance/warp/head_colour.h"

namespace cyclorama::scan {

enum class TestPicture {
  kLines,  ///< Lines every 2 degrees of azimuth and elevation, each tenth stronger; they must continue across seams.
  kWhite,  ///< Uniform white; no seam may be visible.
};

/// Returns the linear light, 0 to 1, that an eye at the sweet spot should see in a direction.
[[nodiscard]] double test_light(TestPicture picture, const Eigen::Vector3d& direction);

/// Description of how one head is drawn. Borrows mask and colour.
struct DrawnHead {
  int width_px = 0;
  int height_px = 0;
  /// Maps a continuous pixel position to its direction; returns nothing where the head draws nothing.
  std::function<std::optional<Eigen::Vector3d>(const Eigen::Vector2d&)> direction_at;
  const warp::MaskImage* mask = nullptr;     ///< Mask of the head's size; null: none.
  const warp::HeadColour* colour = nullptr;  ///< Null means sRGB.
};

/// Draws the head. Reentrant.
[[nodiscard]] RgbImage drawn_head(const DrawnHead& head, TestPicture picture);

}  // namespace cyclorama::scan
