// SPDX-License-Identifier: Apache-2.0
/// The picture space of the whole system: the panorama of the sweet spot, indexed by viewing direction.
///
///   azimuth a           radians to the right of the heading, linear across the picture
///   tan_elevation t     tangent of the angle above the horizon, linear down the picture (top is largest)
///   direction           (sin a, t, -cos a), not normalised, in the Eye frame
///
/// On a cylinder around the eye, (a, t) is the unrolled wall; turning the eye is a shift in `a`.
#pragma once

#include <Eigen/Core>

#include "common/base/result.h"

namespace cyclorama {

/// A position in a panorama, in pixels; the centre of the first pixel is (0.5, 0.5).
struct PanoramaPixel {
  double u = 0.0;
  double v = 0.0;
};

/// The shape of one cylindrical panorama. A value; reentrant.
struct Panorama {
  int width_px = 0;
  int height_px = 0;
  double azimuth_span_rad = 0.0;      ///< Whole width, at most 2 pi; azimuth 0 is the middle.
  double tan_elevation_top = 0.0;     ///< At the upper edge of the first row.
  double tan_elevation_bottom = 0.0;  ///< At the lower edge of the last row.

  /// Errors: kInvalidArgument, with the field's name, unless the picture is 1 to 16384 px each way, the span is in (0,
  /// 2 pi], top > bottom, and all values are finite.
  [[nodiscard]] Status validate() const;

  [[nodiscard]] double radians_per_px() const { return azimuth_span_rad / width_px; }
  [[nodiscard]] double azimuth_at(double u) const { return (u / width_px - 0.5) * azimuth_span_rad; }
  [[nodiscard]] double tan_elevation_at(double v) const {
    return tan_elevation_top + (tan_elevation_bottom - tan_elevation_top) * v / height_px;
  }
  /// Returns a direction that is not normalised; its horizontal length is 1.
  [[nodiscard]] Eigen::Vector3d direction_at(PanoramaPixel p) const;
  /// Inverse of direction_at(), also for positive multiples of a direction. The result may lie outside the picture.
  /// Straight up or down there is no position, and v is +-infinity.
  [[nodiscard]] PanoramaPixel pixel_of(const Eigen::Vector3d& direction) const;

  /// Returns the picture grown by at least `guard_rad` on each side, with pixels of the same angular size, to a width
  /// that is a multiple of 16, but never beyond a full circle. The farm renders this picture, so that a display can
  /// turn it.
  [[nodiscard]] Panorama with_guard_band(double guard_rad) const;

  friend bool operator==(const Panorama&, const Panorama&) = default;
};

/// True if the picture spans the full circle to within a pixel, so that its left edge continues its right edge.
[[nodiscard]] bool is_whole_turn(const Panorama& picture);

/// Returns the angle in (-pi, pi] that differs from `angle` by full turns.
[[nodiscard]] double wrapped_angle(double angle);

}  // namespace cyclorama
