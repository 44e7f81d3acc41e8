// SPDX-License-Identifier: Apache-2.0
/// Noise out of a film of few samples per pixel, by what the surfaces say about which pixels belong together.
///
/// Light is divided by the surfaces' albedo, so that textures stay sharp; fireflies are taken down to what their
/// neighbours can explain; three levels of an à-trous filter average pixels whose normal, tangent plane and light are
/// alike, the latter measured in standard errors. So the filter does ever less as samples are added, and at many
/// samples the picture is the film's own. It has a bias; measure_gain() tells how
/// large it is for a scene.
#pragma once

#include "renderfarm/denoise/guide.h"

namespace cyclorama {

/// Keeps its memory from one picture to the next. Thread-bound.
class Denoiser {
 public:
  /// How far around a block the film must reach, where the picture goes on, so that the block's pixels are those of the
  /// whole picture to the last bit, on any processor.
  [[nodiscard]] static int halo_px();

  /// Writes the denoised mean of `part` of `film` to the same place of `ret_picture`; exposed linear light. Reads the
  /// film up to halo_px() around the part. Whatever the film holds, the result is finite; it is black where there are
  /// no finite samples. Parts may be done at the same time by several denoisers. Precondition: the film has features,
  /// `rays` and `ret_picture` are of its size, and the part lies inside.
  void denoise(const Film& film, const PixelRays& rays, const PixelRect& part, RadianceImage* ret_picture);

 private:
  GuideMaker maker_;
  Guide guide_;
  LightPlanes other_;
  Plane scratch_;
};

/// The whole of `film`, by the calling thread.
[[nodiscard]] RadianceImage denoised(const Film& film, const PixelRays& rays);

}  // namespace cyclorama
