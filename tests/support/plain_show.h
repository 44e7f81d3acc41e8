// SPDX-License-Identifier: Apache-2.0
/// Minimal frames and heads for tests of displays.
#pragma once

#include <algorithm>
#include <memory>
#include <utility>

#include "tests/support/painted_head.h"

namespace cyclorama {

inline PlanarPicture plain(int width, int height, std::uint8_t code, bool half = false) {
  PlanarPicture picture(width, height, half);
  std::ranges::fill(picture.luma().data(), code);
  return picture;
}

/// Returns a frame that spans 1.4 radians and may be turned by 0.2 radians either way.
inline std::unique_ptr<display::DisplayFrame> frame_of(std::uint64_t number, const PlanarPicture& picture,
                                                       double heading_rad = 0.0) {
  auto frame = std::make_unique<display::DisplayFrame>(
      PaintedHead::frame(picture, Panorama{picture.width(), picture.height(), 1.4, 0.5, -0.5}, nullptr));
  frame->order = number;
  frame->number = number;
  frame->heading_rad = heading_rad;
  frame->turn_limit_rad = 0.2;
  return frame;
}

/// Returns a head with a field of view of one radian, straight ahead.
inline display::HeadPlan plain_head(int width, int height) {
  const auto right = static_cast<float>(width);
  const auto bottom = static_cast<float>(height);
  warp::WarpMesh mesh{width, height, 1, 1, {}, 0.0};
  mesh.vertices = {
      {0, 0, -0.5f, 0.5f}, {right, 0, 0.5f, 0.5f}, {0, bottom, -0.5f, -0.5f}, {right, bottom, 0.5f, -0.5f}};
  display::HeadPlan plan;
  plan.warp = std::move(mesh);
  plan.mask = warp::MaskImage(width, height, 1.0f);
  return plan;
}

}  // namespace cyclorama
