// SPDX-License-Identifier: Apache-2.0
/// Removes noise from a film with few samples per pixel, guided by the surfaces that the pixels show.
///
/// Light is divided by the surfaces' albedo, which keeps textures sharp; fireflies are reduced to what their neighbours
/// can explain; three levels of an à-trous filter average pixels of similar normal, tangent plane and light, the latter
/// measured in standard errors. The filter therefore acts less as samples are added, and at many samples it leaves the
/// film unchanged. It has a bias, which measure_gain() measures for a scene.
#pragma once

#include "renderfarm/denoise/guide.h"

namespace cyclorama::denoise {

/// Denoises films. Keeps its memory from one picture to the next. Thread-bound.
class Denoiser {
 public:
  /// Returns the width of the margin that a block needs around it, inside the picture, for its pixels to equal those of
  /// the whole picture to the last bit, on any processor.
  [[nodiscard]] static int halo_px();

  /// Writes the denoised mean of `part` of `film` to the same position in `ret_picture`, as exposed linear light. Reads
  /// the film up to halo_px() around the part. The result is always finite; it is black where there are no finite
  /// samples. Several denoisers may process parts concurrently. Precondition: the film has features, `rays` and
  /// `ret_picture` have its size, and the part lies inside.
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
