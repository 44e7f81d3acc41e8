// SPDX-License-Identifier: Apache-2.0
/// A film prepared for filtering: its light without the surfaces' colour, the light's uncertainty, and the geometry of
/// the surfaces.
#pragma once

#include "renderfarm/denoise/pixel_rays.h"
#include "renderfarm/denoise/plane.h"
#include "renderfarm/render/film.h"

namespace cyclorama::denoise {

/// The light to be filtered, one plane per quantity.
struct LightPlanes {
  void reshape(int width, int height);
  Plane red, green, blue;  ///< Mean radiance over albedo.
  Plane luminance;         ///< Luminance of `red`, `green` and `blue`.
  Plane variance;          ///< Variance of `luminance`.
};

/// Input of the filter for a part of a film. All planes have the part's size. All values are finite.
struct Guide {
  void reshape(int width, int height);
  [[nodiscard]] int width() const { return weight.width(); }
  [[nodiscard]] int height() const { return weight.height(); }

  LightPlanes light;  ///< Light without fireflies.
  Plane weight;       ///< 1, or 0 for a pixel without finite samples; such a pixel is black.
  /// Squared difference of luminance, in variances, within which neighbours are averaged; falls to 0 with many samples.
  Plane tolerance;
  Plane normal_x, normal_y, normal_z;  ///< Zero if the eye sees no surface.
  Plane place_x, place_y, place_z;     ///< Position relative to the eye in metres.
  Plane plane_offset;                  ///< Dot product of normal and position.
  Plane per_footprint;                 ///< Inverse of the pixel's width at the surface, 1/m.
};

/// Radius of the neighbourhood that GuideMaker reads around a pixel.
inline constexpr int kGuideReachPx = 3;

/// Makes guides. Reuses its memory, because allocation would take longer than the whole filter. Thread-bound.
class GuideMaker {
 public:
  /// Divides the light of `part` of the film by albedo, reduces fireflies to values that their neighbours can explain,
  /// and estimates the variance. Reads nothing outside the part.
  ///
  /// The variance is that of the pixel's samples, averaged over its neighbours, which have different samples but a
  /// similar spread. With one sample per pixel, only the scatter among neighbours is available, which includes edges.
  /// Precondition: the film has features, `rays` has its size, and the part is inside the film.
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

/// Multiplies light by albedo, which reverses the division by GuideMaker. Reads `part` of the light and writes to the
/// position (`to_x`, `to_y`) of the picture, which has the size of `albedo`.
void remodulate(const LightPlanes& light, const PixelRect& part, const RadianceImage& albedo, int to_x, int to_y,
                RadianceImage* ret_picture);

}  // namespace cyclorama::denoise
