// SPDX-License-Identifier: Apache-2.0
/// A film, laid out for filtering: light without the surfaces' colour, how uncertain it is, and where the surfaces are.
#pragma once

#include "renderfarm/denoise/pixel_rays.h"
#include "renderfarm/denoise/plane.h"
#include "renderfarm/render/film.h"

namespace cyclorama {

/// Light that is filtered: one plane per number.
struct LightPlanes {
  void reshape(int width, int height);
  Plane red, green, blue;  ///< Mean radiance over albedo.
  Plane luminance;         ///< Of those.
  Plane variance;          ///< Of `luminance`.
};

/// What the filter reads: of a part of a film, all planes of the part's size. Every value is finite.
struct Guide {
  void reshape(int width, int height);
  [[nodiscard]] int width() const { return weight.width(); }
  [[nodiscard]] int height() const { return weight.height(); }

  LightPlanes light;  ///< Without fireflies.
  Plane weight;       ///< 1; 0 where there are no samples or they are not finite: such a pixel is black.
  /// How far neighbours may differ in luminance, squared, and still be of one kind: falls to 0 with many samples.
  Plane tolerance;
  Plane normal_x, normal_y, normal_z;  ///< Zero where the eye sees no surface.
  Plane place_x, place_y, place_z;     ///< Metres from the eye.
  Plane plane_offset;                  ///< normal . place
  Plane per_footprint;                 ///< One over the pixel's width at the surface, metres.
};

/// How far around a pixel GuideMaker looks.
inline constexpr int kGuideReachPx = 3;

/// Makes guides. It keeps its memory from one to the next: getting it afresh takes longer than the whole filter.
/// Thread-bound.
class GuideMaker {
 public:
  /// Demodulates, takes fireflies down to what their neighbours can explain, and finds the variance, of `part` of the
  /// film. Nothing outside of the part is looked at.
  ///
  /// The variance is that of the pixel's own samples, averaged over its neighbours, which have different samples and
  /// much the same spread; with one sample per pixel there is only the scatter among the neighbours, edges and all.
  /// Precondition: the film has features, `rays` is of its size, and the part lies inside.
  void make(const Film& film, const PixelRays& rays, const PixelRect& part, Guide* ret);

 private:
  /// Sums over each pixel's neighbourhood.
  struct Moments {
    Plane count, sum, square;
  };

  void split_light(const Film& film, const PixelRect& part, Guide* ret);
  void tame_fireflies(Guide* guide);
  void pool_variance(Guide* guide);
  void sum_moments(const Guide& guide, int radius);

  Plane per_sample_;  ///< One over the number of samples; 0 where the weight is.
  Moments around_;
  Plane own_sum_, own_count_;
  Plane scale_;
  Plane scratch_;
};

/// Light times albedo, undoing what GuideMaker divided: of `part` of the guide, to `to_x`, `to_y` of the picture, which
/// has the size of `albedo`.
void remodulate(const LightPlanes& light, const PixelRect& part, const RadianceImage& albedo, int to_x, int to_y,
                RadianceImage* ret_picture);

}  // namespace cyclorama
