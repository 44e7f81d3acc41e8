// SPDX-License-Identifier: Apache-2.0
/// Places in a picture of any shape, whatever its pixels, and what becomes of them when the visitor turns.
///
///   shape            across                            up
///   panorama         azimuth, rad                      tangent of elevation
///   perspective      tangent, rightwards of the axis   tangent, above the axis
///   fisheye          angle from the axis, rad, as an arrow rightwards and upwards
///   equirectangular  azimuth, rad                      elevation, rad
///
/// A place stays when the picture gets more pixels or a guard band; pixels are even in places. Of a shape only its kind
/// and its tilt count. Reentrant, double.
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

/// u = u_per_across * across + u_offset, and v alike; v_per_up is below zero.
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
  /// Between two places, in pixels.
  [[nodiscard]] double distance_px(const PicturePlace& a, const PicturePlace& b) const {
    return std::hypot(u_per_across * (a.across - b.across), v_per_up * (a.up - b.up));
  }
};
[[nodiscard]] PixelScale pixel_scale(const PictureShape& shape);
/// The same places with other pixels.
[[nodiscard]] PictureShape with_pixels(PictureShape shape, int width_px, int height_px);
/// Whether places mean the same in both: they are of one kind and tilt.
[[nodiscard]] bool has_same_places(const PictureShape& a, const PictureShape& b);

/// The picture's axes (x right, y up, z against its axis) seen in the Eye frame.
[[nodiscard]] Eigen::Matrix3d R_eye_picture(const PictureShape& shape);

/// Eye frame; length as direction_at()'s.
[[nodiscard]] Eigen::Vector3d direction_of(const PictureShape& shape, const PicturePlace& place);
/// The inverse, for any positive multiple, in an endless picture: a fisheye does not end at its field. Nothing straight
/// up or down in a panorama, at a right angle to a perspective's axis and behind it, and exactly against a fisheye's.
[[nodiscard]] std::optional<PicturePlace> place_of(const PictureShape& shape, const Eigen::Vector3d& direction);

/// Where what a visitor who has turned to the right by `turn_rad` sees at `place` lies in the picture of before: in a
/// panorama a shift; in the others a rotation about the vertical. Nothing as for place_of().
[[nodiscard]] std::optional<PicturePlace> turned(const PictureShape& shape, const PicturePlace& place, double turn_rad);

}  // namespace cyclorama
