// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <span>

#include "appliance/structured_light/photo.h"
#include "common/base/result.h"

namespace cyclorama::structured_light {

using ExposureTime = std::chrono::duration<double>;

/// Exposure limits of the camera, and requirements of the projector.
struct ExposureLimits {
  ExposureTime shortest{1e-4};
  ExposureTime longest{0.25};
  /// Longer exposures are used only if the picture would otherwise be too dim, since a scan takes hundreds of
  /// photographs.
  ExposureTime preferred_max{0.1};
  /// A projector that shows colours in sequence is seen correctly only over whole refreshes, so exposures are multiples
  /// of this period if possible. 0 means any exposure.
  ExposureTime projector_period{1.0 / 60.0};
};

/// Statistics of a photograph of the white picture, for judging its exposure.
struct ExposureSample {
  ExposureTime exposure{0.0};
  double saturated = 0.0;  ///< Saturated fraction of the pixels that the projector lights.
  double bright = 0.0;     ///< 99.5th percentile over these pixels, in units of Photo.
  double lit = 0.0;        ///< Fraction of all pixels that the projector lights.
};

/// Computes the statistics. Precondition: `white` and `black` have the same exposure. A pixel counts as lit if white
/// exceeds black by at least 0.02 or is saturated. Reentrant.
[[nodiscard]] ExposureSample exposure_sample(ExposureTime exposure, const Photo& white, const Photo& black);

struct ExposureAdvice {
  ExposureTime exposure{0.0};
  bool is_good = false;  ///< True if the newest sample has this exposure, and may be used.
};

/// Target of ExposureSample::bright; 0.6 to 0.9 is accepted. From ExposureLimits::preferred_max on, the target is
/// kDimAim, and 0.3 is accepted.
inline constexpr double kBrightAim = 0.8;
inline constexpr double kDimAim = 0.35;

/// Returns the exposure to try next, given all samples so far; two or three samples usually suffice. A pure function.
///
/// Errors: kInvalidArgument for invalid limits or if no sample has an exposure; kBadData if no exposure within the
/// limits is suitable, with the remedy to open or to close the iris.
[[nodiscard]] Result<ExposureAdvice> next_exposure(std::span<const ExposureSample> samples,
                                                   const ExposureLimits& limits);

}  // namespace cyclorama::structured_light
