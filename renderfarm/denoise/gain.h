// SPDX-License-Identifier: Apache-2.0
/// What denoising wins and what it costs in truth, reported apart.
#pragma once

#include <functional>
#include <span>

#include "common/base/result.h"
#include "renderfarm/render/film.h"

namespace cyclorama {

/// Mean squared errors over pixels and channels, each divided by (reference^2 + 0.01), as in relMSE. A value.
struct DenoiseGain {
  double mse_before = 0.0;  ///< Of the films' means, averaged over the films.
  double mse_after = 0.0;   ///< Of the denoised pictures: bias2 + variance_after, up to the reference's own noise.
  double bias2 = 0.0;       ///< What stays however many denoised pictures are averaged. Unbiased, so it may be below 0.
  double variance_after = 0.0;  ///< What goes.

  [[nodiscard]] double gain() const { return mse_before / mse_after; }
  [[nodiscard]] double bias_share() const { return bias2 / mse_after; }
};

using DenoiseFilm = std::function<RadianceImage(const Film&)>;

/// From independent films (other seeds) of one view. `denoise` is called once for each.
/// kInvalidArgument  fewer than two films, or sizes differ.
[[nodiscard]] Result<DenoiseGain> measure_gain(const RadianceImage& reference, std::span<const Film> films,
                                               const DenoiseFilm& denoise);

}  // namespace cyclorama
