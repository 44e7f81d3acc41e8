// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

namespace cyclorama {

/// A distortion-free lens of a camera or of a projector, which is modelled as an inverse camera.
///
///       | f  0   cx |     u right, v down, the CENTRE of the first pixel at (0.5, 0.5); f, cx, cy in pixels.
///   K = | 0  a f cy |     A lens shift moves (cx, cy) away from the middle. a is a pixel's width over its height.
///       | 0  0   1  |
///
/// Frames: x right, y down, z forward. A value; reentrant.
struct Pinhole {
  int width_px = 0;
  int height_px = 0;
  double focal_px = 0.0;
  double centre_u_px = 0.0;
  double centre_v_px = 0.0;
  double pixel_aspect = 1.0;  ///< Other than 1 where two eyes share a projector's pixels.

  /// Returns a centred lens whose whole width spans `horizontal_fov_rad`.
  static Pinhole from_field_of_view(int width_px, int height_px, double horizontal_fov_rad);

  /// Returns the line of sight through a pixel; not normalised, z is 1.
  [[nodiscard]] Eigen::Vector3d direction_at(double u, double v) const {
    return {(u - centre_u_px) / focal_px, (v - centre_v_px) / (pixel_aspect * focal_px), 1.0};
  }
  /// Returns the lens with the same field of view and another number of pixels.
  [[nodiscard]] Pinhole with_pixels(int new_width_px, int new_height_px) const;
  /// Returns the pixel of a point, which may lie outside the picture; empty if the point is behind the lens.
  [[nodiscard]] std::optional<Eigen::Vector2d> pixel_of(const Eigen::Vector3d& point) const;
  [[nodiscard]] bool contains(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= 0.0 && pixel.x() <= width_px && pixel.y() >= 0.0 && pixel.y() <= height_px;
  }
};

}  // namespace cyclorama
