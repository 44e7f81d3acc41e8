// SPDX-License-Identifier: Apache-2.0
/// What rays bring home: per pixel sums over samples, so that films of the same view add up.
#pragma once

#include <cstdint>
#include <vector>

#include "common/image/image.h"

namespace cyclorama {

using ScalarImage = Image<float, 1>;

/// What the first surface is, for a denoiser: means over the pixel's samples.
struct FilmFeatures {
  RadianceImage albedo;  ///< Of all lobes; 1 where the eye sees no surface, 0 where the picture shows nothing.
  RadianceImage normal;  ///< Shading normal, render frame; zero where the eye sees no surface.
  ScalarImage distance;  ///< Metres along the ray; 0 where the eye sees no surface.
};

/// A value. All images have the same size; linear light, exposed (radiance times the scene's exposure).
struct Film {
  RadianceImage sum;   ///< Of the samples' radiance.
  ScalarImage square;  ///< Of the samples' squared luminance.
  Image<std::int32_t, 1> samples;
  FilmFeatures features;  ///< Empty unless asked for.

  Film() = default;
  Film(int width, int height, bool with_features);
  [[nodiscard]] int width() const { return sum.width(); }
  [[nodiscard]] int height() const { return sum.height(); }

  /// Precondition: the same size, samples of other numbers, and features in both or in neither.
  void add(const Film& other);
  /// Mean radiance; black where there are no samples.
  [[nodiscard]] RadianceImage mean() const;
  /// Of the mean's luminance, from the samples' own scatter (an overestimate: the samples are stratified). Infinite
  /// below two samples.
  [[nodiscard]] ScalarImage variance() const;
};

}  // namespace cyclorama
