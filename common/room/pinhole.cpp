// SPDX-License-Identifier: Apache-2.0
#include "common/room/pinhole.h"

#include <cmath>

namespace cyclorama {

Pinhole Pinhole::from_field_of_view(int width_px, int height_px, double horizontal_fov_rad) {
  Pinhole lens;
  lens.width_px = width_px;
  lens.height_px = height_px;
  lens.focal_px = 0.5 * width_px / std::tan(0.5 * horizontal_fov_rad);
  lens.centre_u_px = 0.5 * width_px;
  lens.centre_v_px = 0.5 * height_px;
  return lens;
}

Pinhole Pinhole::with_pixels(int new_width_px, int new_height_px) const {
  const double across = static_cast<double>(new_width_px) / width_px;
  const double down = static_cast<double>(new_height_px) / height_px;
  return {new_width_px,         new_height_px,      across * focal_px,
          across * centre_u_px, down * centre_v_px, pixel_aspect * down / across};
}

std::optional<Eigen::Vector2d> Pinhole::pixel_of(const Eigen::Vector3d& point) const {
  if (!(point.z() > 1e-12)) return std::nullopt;
  return Eigen::Vector2d(centre_u_px + focal_px * point.x() / point.z(),
                         centre_v_px + pixel_aspect * focal_px * point.y() / point.z());
}

}  // namespace cyclorama
