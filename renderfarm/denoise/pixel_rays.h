// SPDX-License-Identifier: Apache-2.0
/// Directions of a film's pixels, independent of the camera model.
#pragma once

#include "common/geometry/projection.h"
#include "common/image/pixel_rect.h"
#include "renderfarm/render/film.h"

namespace cyclorama::denoise {

/// Directions of the pixels in a rectangle. A value.
struct PixelRays {
  RadianceImage directions;      ///< Unit vectors through pixel centres, in the frame of the film's normals.
  double radians_per_px = 1e-3;  ///< Approximate angle between neighbours.
};

/// Returns the directions for `rect` of a panorama. A pixel's direction does not depend on the rect. Precondition:
/// panorama.validate().
[[nodiscard]] PixelRays panorama_rays(const Panorama& panorama, double heading_rad, const PixelRect& rect);
/// Returns the directions for a picture of any shape. A pixel outside a fisheye's circle, which has no samples, gets
/// the direction of the axis.
[[nodiscard]] PixelRays picture_rays(const PictureShape& shape, double heading_rad, const PixelRect& rect);
/// Returns the directions for one eye or two; each ray starts at its eye. Neighbouring pixels have nearly the same eye
/// position: within the filter's radius, the eye moves by less than a millimetre.
[[nodiscard]] PixelRays picture_rays(const Projection& picture, double heading_rad, const PixelRect& rect);

}  // namespace cyclorama::denoise
