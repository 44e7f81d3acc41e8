// SPDX-License-Identifier: Apache-2.0
/// Gain of denoising and the bias that it introduces, reported separately.
#pragma once

#include <functional>
#include <span>

#include "common/base/result.h"
#include "renderfarm/render/film.h"

namespace cyclorama::denoise {

/// Mean squared errors over pixels and channels, each divided by (reference^2 + 0.01), as in relMSE. A value.
struct DenoiseGain {
  double mse_before = 0.0;  ///< Mean of the films' own errors.
  double mse_after = 0.0;   ///< Denoised pictures: bias2 + variance_after, up to the reference's own noise.
  /// Error that averaging denoised pictures does not remove. An unbiased estimate, so it may be negative.
  double bias2 = 0.0;
  double variance_after = 0.0;  ///< Error that averaging removes.

  [[nodiscard]] double gain() const { return mse_before / mse_after; }
  [[nodiscard]] double bias_share() const { return bias2 / mse_after; }
};

using DenoiseFilm = std::function<RadianceImage(const render::Film&)>;

/// Measures the gain from independent films (of different seeds) of one view. `denoise` is called once for each.
/// Errors: kInvalidArgument if there are fewer than two films, or if sizes differ.
[[nodiscard]] Result<DenoiseGain> measure_gain(const RadianceImage& reference, std::span<const render::Film> films,
                                               const DenoiseFilm& denoise);

}  // namespace cyclorama::denoise
