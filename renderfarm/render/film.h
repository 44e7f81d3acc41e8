// SPDX-License-Identifier: Apache-2.0
/// Sums over the samples of each pixel; films of the same view can be added.
#pragma once

#include <cstdint>
#include <vector>

#include "common/image/image.h"
#include "common/image/inverse_depth.h"

namespace cyclorama::render {

using ScalarImage = Image<float, 1>;

/// Features of the first surface for a denoiser: means over the pixel's samples.
struct FilmFeatures {
  RadianceImage albedo;  ///< Sum over all lobes; 1 where the eye sees no surface, 0 where a pixel has no ray.
  RadianceImage normal;  ///< Shading normal, render frame; zero where the eye sees no surface.
  ScalarImage distance;  ///< Metres along the ray; 0 where the eye sees no surface.
};

/// A value. All images except `depth` have the same size. Light is linear and exposed: radiance times the scene's
/// exposure.
struct Film {
  RadianceImage sum;   ///< Sum of the samples' radiance.
  ScalarImage square;  ///< Sum of the samples' squared luminance.
  Image<std::int32_t, 1> samples;
  FilmFeatures features;  ///< Empty unless requested.
  /// Inverse depth of the cells that the film's part of the picture touches. Each cell is computed from all of its
  /// samples, including those outside the part. Empty unless the view requests depth.
  InverseDepthImage depth;

  Film() = default;
  Film(int width, int height, bool with_features);
  [[nodiscard]] int width() const { return sum.width(); }
  [[nodiscard]] int height() const { return sum.height(); }

  /// Adds the samples of `other`. Precondition: both films show the same part of the picture with disjoint sample
  /// numbers; either both or neither have features, and likewise depth.
  void add(const Film& other);
  /// Returns the mean radiance; black where there are no samples.
  [[nodiscard]] RadianceImage mean() const;
  /// Returns the variance of the mean's luminance, estimated from the scatter of the samples (an overestimate, because
  /// they are stratified). Infinite for fewer than two samples.
  [[nodiscard]] ScalarImage variance() const;
};

}  // namespace cyclorama::render
