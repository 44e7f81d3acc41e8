// SPDX-License-Identifier: Apache-2.0
/// Where the pixels of a film look, whatever camera made it.
#pragma once

#include "common/geometry/projection.h"
#include "common/image/pixel_rect.h"
#include "renderfarm/render/film.h"

namespace cyclorama {

/// A value.
struct PixelRays {
  RadianceImage directions;      ///< Unit length, of the pixels' centres, in the frame of the film's normals.
  double radians_per_px = 1e-3;  ///< Between neighbours, about.
};

/// Of `rect` of a panorama. A pixel gets the same direction in whatever rect. Precondition: panorama.validate().
[[nodiscard]] PixelRays panorama_rays(const Panorama& panorama, double heading_rad, const PixelRect& rect);
/// The same of a picture of any shape. Outside of a fisheye's circle, where there are no samples, along its axis.
[[nodiscard]] PixelRays picture_rays(const PictureShape& shape, double heading_rad, const PixelRect& rect);
/// The same for one eye or two, each ray from where its own eye is. Neighbours have nearly one eye: within a filter's
/// reach it moves by less than a millimetre.
[[nodiscard]] PixelRays picture_rays(const Projection& picture, double heading_rad, const PixelRect& rect);

}  // namespace cyclorama
