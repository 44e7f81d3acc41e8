// SPDX-License-Identifier: Apache-2.0
/// Draws test pictures for a head pixel by pixel, as the display would draw them through the warp.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "appliance/warp/blend_mask.h"
#include "appliance/warp/head_colour.h"

namespace cyclorama::scan {

enum class TestPicture {
  kLines,  ///< Lines every 2 degrees, brighter ones every 10 degrees; they must continue across seams.
  kWhite,  ///< Uniform white; no seam may be visible.
};

/// Returns the linear light, 0 to 1, that an eye at the sweet spot should see in a direction.
[[nodiscard]] double test_light(TestPicture picture, const Eigen::Vector3d& direction);

/// Geometry and colour with which one head is drawn. Borrows `mask` and `colour`.
struct DrawnHead {
  int width_px = 0;
  int height_px = 0;
  /// Maps a continuous pixel position to its direction; returns nothing where the head draws nothing.
  std::function<std::optional<Eigen::Vector3d>(const Eigen::Vector2d&)> direction_at;
  const warp::MaskImage* mask = nullptr;     ///< Has the head's size; null means no mask.
  const warp::HeadColour* colour = nullptr;  ///< Null means sRGB.
};

/// Returns the head's picture of a test picture. Reentrant.
[[nodiscard]] RgbImage drawn_head(const DrawnHead& head, TestPicture picture);

}  // namespace cyclorama::scan
