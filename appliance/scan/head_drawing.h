// SPDX-License-Identifier: Apache-2.0
/// What a head shows of a test picture, plainly: pixel by pixel, as the display would draw it through the warp.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "appliance/warp/blend_mask.h"
#include "appliance/warp/head_colour.h"

namespace cyclorama::scan {

enum class TestPicture {
  kLines,  ///< Every two degrees of azimuth and elevation, every tenth stronger: where pictures meet lines go on.
  kWhite,  ///< Evenly: where pictures meet nothing is to be seen.
};

/// Linear light, 0 to 1, that an eye at the sweet spot should see along a direction.
[[nodiscard]] double test_light(TestPicture picture, const Eigen::Vector3d& direction);

/// How one head is drawn. Borrows mask and colour.
struct DrawnHead {
  int width_px = 0;
  int height_px = 0;
  /// Of a pixel, continuous; nothing where nothing is drawn.
  std::function<std::optional<Eigen::Vector3d>(const Eigen::Vector2d&)> direction_at;
  const warp::MaskImage* mask = nullptr;     ///< Of the head's size; null: none.
  const warp::HeadColour* colour = nullptr;  ///< Null: sRGB.
};

/// Reentrant.
[[nodiscard]] RgbImage drawn_head(const DrawnHead& head, TestPicture picture);

}  // namespace cyclorama::scan
