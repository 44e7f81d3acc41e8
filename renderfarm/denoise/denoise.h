// SPDX-License-Identifier: Apache-2.0
/// Removes noise from a film with few samples per pixel, guided by the surfaces that the pixels show.
///
/// Light is divided by the surfaces' albedo, which keeps textures sharp, and fireflies are reduced to values that their
/// neighbours can explain. Then three levels of an à-trous filter average pixels with similar normals, tangent planes
/// and light; differences of light are measured in standard errors. Therefore the filter acts less as samples are
/// added, and leaves a film with many samples unchanged. measure_gain() measures its bias for a scene.
#pragma once

#include "renderfarm/denoise/guide.h"

namespace cyclorama::denoise {

/// Denoises films. Reuses its memory for successive pictures. Thread-bound.
class Denoiser {
 public:
  /// Returns the width of the margin that a block needs on each side, within the picture, for its pixels to be
  /// bit-identical to those of the whole picture, on any processor.
  [[nodiscard]] static int halo_px();

  /// Writes the denoised mean of `part` of `film` to the same position in `ret_picture`, as exposed linear light. Reads
  /// the film up to halo_px() around the part. The result is always finite; pixels without finite samples are black.
  /// Several denoisers may process parts of a film concurrently. Precondition: the film has features, `rays` and
  /// `ret_picture` have its size, and the part is inside the film.
  void denoise(const render::Film& film, const PixelRays& rays, const PixelRect& part, RadianceImage* ret_picture);

 private:
  GuideMaker maker_;
  Guide guide_;
  LightPlanes other_;
  Plane scratch_;
};

/// Denoises all of `film` on the calling thread.
[[nodiscard]] RadianceImage denoised(const render::Film& film, const PixelRays& rays);

}  // namespace cyclorama::denoise
