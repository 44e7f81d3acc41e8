// SPDX-License-Identifier: Apache-2.0
/// Positions in a picture of any shape, independent of its pixels, and their movement when the visitor turns.
///
///   shape            across                            up
///   panorama         azimuth, rad                      tangent of elevation
///   perspective      tangent, right of the axis        tangent, above the axis
///   fisheye          angle from the axis, rad, as a vector to the right and upwards
///   equirectangular  azimuth, rad                      elevation, rad
///
/// A position stays the same when the picture gets more pixels or a guard band. Pixels are evenly spaced in these
/// coordinates. Only a shape's kind and its tilt matter. Reentrant, double.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>

#include "common/geometry/projection.h"

namespace cyclorama {

struct PicturePlace {
  double across = 0.0;
  double up = 0.0;
  friend bool operator==(const PicturePlace&, const PicturePlace&) = default;
};

/// Converts positions to pixels: u = u_per_across * across + u_offset, and v = v_per_up * up + v_offset, where v_per_up
/// is negative.
struct PixelScale {
  double u_per_across = 1.0;
  double u_offset = 0.0;
  double v_per_up = -1.0;
  double v_offset = 0.0;

  [[nodiscard]] PanoramaPixel pixel_at(const PicturePlace& place) const {
    return {u_per_across * place.across + u_offset, v_per_up * place.up + v_offset};
  }
  [[nodiscard]] PicturePlace place_at(const PanoramaPixel& pixel) const {
    return {(pixel.u - u_offset) / u_per_across, (pixel.v - v_offset) / v_per_up};
  }
  /// Returns the distance between two positions in pixels.
  [[nodiscard]] double distance_px(const PicturePlace& a, const PicturePlace& b) const {
    return std::hypot(u_per_across * (a.across - b.across), v_per_up * (a.up - b.up));
  }
};
[[nodiscard]] PixelScale pixel_scale(const PictureShape& shape);
/// Returns the same shape with another number of pixels; positions do not change.
[[nodiscard]] PictureShape with_pixels(PictureShape shape, int width_px, int height_px);
/// True if positions have the same meaning in both shapes, which are then of the same kind and tilt.
[[nodiscard]] bool has_same_places(const PictureShape& a, const PictureShape& b);

/// Returns the picture's axes (x right, y up, z opposite to its optical axis) in the Eye frame.
[[nodiscard]] Eigen::Matrix3d R_eye_picture(const PictureShape& shape);

/// Returns the direction of a position in the Eye frame, of the same length as that of direction_at().
[[nodiscard]] Eigen::Vector3d direction_of(const PictureShape& shape, const PicturePlace& place);
/// Returns the position of a direction of any length in an unbounded picture; a fisheye's field does not limit it.
/// Empty straight up or down in a panorama, at a right angle to a perspective's axis or behind it, and exactly opposite
/// to a fisheye's axis.
[[nodiscard]] std::optional<PicturePlace> place_of(const PictureShape& shape, const Eigen::Vector3d& direction);

/// Returns the position, in the picture before the turn, that a visitor who has turned right by `turn_rad` sees at
/// `place`: a shift in a panorama, a rotation about the vertical in other shapes. Empty where place_of() is.
[[nodiscard]] std::optional<PicturePlace> turned(const PictureShape& shape, const PicturePlace& place, double turn_rad);

}  // namespace cyclorama
