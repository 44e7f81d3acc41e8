// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <span>

#include "appliance/structured_light/photo.h"
#include "common/base/result.h"

namespace cyclorama::structured_light {

using ExposureTime = std::chrono::duration<double>;

/// What a camera can do, and what the projector asks of it.
struct ExposureLimits {
  ExposureTime shortest{1e-4};
  ExposureTime longest{0.25};
  /// Longer ones are taken only as far as the picture would be too dim without: a scan has hundreds of photographs.
  ExposureTime preferred_longest{0.1};
  /// A projector that makes its colours one after the other looks right only over whole refreshes: exposures are
  /// multiples of this where that is possible. 0: it does not matter.
  ExposureTime projector_period{1.0 / 60.0};
};

/// What a photograph of the white picture says about its exposure.
struct ExposureSample {
  ExposureTime exposure{0.0};
  double saturated = 0.0;  ///< Fraction of the pixels that the projector lights.
  double bright = 0.0;     ///< What 99.5 % of those stay below, as Photo.
  double lit = 0.0;        ///< Fraction of all pixels that the projector lights.
};

/// `white` and `black` photographed alike. A pixel is lit when it gains at least 0.02 or is saturated. Reentrant.
[[nodiscard]] ExposureSample exposure_sample(ExposureTime exposure, const Photo& white, const Photo& black);

struct ExposureAdvice {
  ExposureTime exposure{0.0};
  bool is_good = false;  ///< The newest sample has this exposure already, and may be used.
};

/// What 99.5 % of the lit pixels are to stay below: 0.6 to 0.9 is good, and 0.8 is aimed at. From
/// ExposureLimits::preferred_longest on 0.3 is enough, and 0.35 is aimed at.
inline constexpr double kBrightAim = 0.8;
inline constexpr double kDimAim = 0.35;

/// From all samples so far to the exposure to try next: two or three lead to a good one. A pure function.
///
/// kInvalidArgument  limits that are none, or no sample with an exposure.
/// kBadData  no exposure within the limits will do; says whether to open or to close the iris.
[[nodiscard]] Result<ExposureAdvice> next_exposure(std::span<const ExposureSample> samples,
                                                   const ExposureLimits& limits);

}  // namespace cyclorama::structured_light
