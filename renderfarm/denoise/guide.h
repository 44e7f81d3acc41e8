// SPDX-License-Identifier: Apache-2.0
/// A film prepared for filtering: light without the surfaces' colour, its uncertainty, and the geometry of the
/// surfaces.
#pragma once

#include "renderfarm/denoise/pixel_rays.h"
#include "renderfarm/denoise/plane.h"
#include "renderfarm/render/film.h"

namespace cyclorama::denoise {

/// The light to be filtered, one plane per value.
struct LightPlanes {
  void reshape(int width, int height);
  Plane red, green, blue;  ///< Mean radiance over albedo.
  Plane luminance;         ///< Luminance of these.
  Plane variance;          ///< Variance of `luminance`.
};

/// Input of the filter for a part of a film; all planes have the part's size. Every value is finite.
struct Guide {
  void reshape(int width, int height);
  [[nodiscard]] int width() const { return weight.width(); }
  [[nodiscard]] int height() const { return weight.height(); }

  LightPlanes light;  ///< Fireflies are removed.
  Plane weight;       ///< 1, or 0 for a pixel without finite samples, which is black.
  /// Squared luminance difference within which neighbours count as alike, in variances; falls to 0 with many samples.
  Plane tolerance;
  Plane normal_x, normal_y, normal_z;  ///< Zero if the eye sees no surface.
  Plane place_x, place_y, place_z;     ///< Metres from the eye.
  Plane plane_offset;                  ///< Dot product of normal and position.
  Plane per_footprint;                 ///< Inverse of the pixel's width at the surface, 1/m.
};

/// Radius around a pixel that GuideMaker reads.
inline constexpr int kGuideReachPx = 3;

/// Creates guides. Keeps its memory between them, because allocation takes longer than the whole filter. Thread-bound.
class GuideMaker {
 public:
  /// Demodulates `part` of the film, reduces fireflies to what their neighbours can explain, and estimates the
  /// variance. Reads nothing outside the part.
  ///
  /// The variance is that of the pixel's own samples, averaged over its neighbours, which have different samples but a
  /// similar spread. With one sample per pixel only the scatter among neighbours is available, which includes edges.
  /// Precondition: the film has features, `rays` has its size, and the part lies inside.
  void make(const render::Film& film, const PixelRays& rays, const PixelRect& part, Guide* ret);

 private:
  /// Sums over each pixel's neighbourhood.
  struct Moments {
    Plane count, sum, square;
  };

  void split_light(const render::Film& film, const PixelRect& part, Guide* ret);
  void tame_fireflies(Guide* guide);
  void pool_variance(Guide* guide);
  void sum_moments(const Guide& guide, int radius);

  Plane per_sample_;  ///< Inverse of the number of samples; 0 where the weight is 0.
  Moments around_;
  Plane own_sum_, own_count_;
  Plane scale_;
  Plane scratch_;
};

/// Multiplies light by albedo, the inverse of GuideMaker's division: from `part` of the guide to position `to_x`,
/// `to_y` of the picture, which has the size of `albedo`.
void remodulate(const LightPlanes& light, const PixelRect& part, const RadianceImage& albedo, int to_x, int to_y,
                RadianceImage* ret_picture);

}  // namespace cyclorama::denoise
