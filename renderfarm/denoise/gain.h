// SPDX-License-Identifier: Apache-2.0
/// Measures the gain of denoising and, separately, the bias that it introduces.
#pragma once

#include <functional>
#include <span>

#include "common/base/result.h"
#include "renderfarm/render/film.h"

namespace cyclorama::denoise {

/// Mean squared errors over pixels and channels. Each error is divided by (reference^2 + 0.01), as in relMSE. A value.
struct DenoiseGain {
  double mse_before = 0.0;  ///< Mean error of the films before denoising.
  /// Mean error of the denoised pictures: bias2 + variance_after. Includes the noise of the reference.
  double mse_after = 0.0;
  /// Error that averaging denoised pictures does not remove. An unbiased estimate, which may be negative.
  double bias2 = 0.0;
  double variance_after = 0.0;  ///< Error that averaging removes.

  [[nodiscard]] double gain() const { return mse_before / mse_after; }
  [[nodiscard]] double bias_share() const { return bias2 / mse_after; }
};

using DenoiseFilm = std::function<RadianceImage(const render::Film&)>;

/// Measures the gain from independent films of one view with different seeds. Calls `denoise` once per film. Errors:
/// kInvalidArgument if there are fewer than two films, or if sizes differ.
[[nodiscard]] Result<DenoiseGain> measure_gain(const RadianceImage& reference, std::span<const render::Film> films,
                                               const DenoiseFilm& denoise);

}  // namespace cyclorama::denoise
