// SPDX-License-Identifier: Apache-2.0
/// Measures all reference projectors, which were not displaced, at once and with a few sines. This suffices because the
/// calibration predicts to within some pixels which projector pixel each camera pixel sees.
///
///     white, black │ columns: 4 sines, shifted by a quarter of a period │ rows likewise     ten photographs
#pragma once

#include <stop_token>
#include <vector>

#include "appliance/scan/view_measuring.h"
#include "appliance/solve/measurements.h"
#include "common/image/image.h"

namespace cyclorama::scan {

/// Period of the sines in projector pixels; the prediction must be right to within a quarter of it.
inline constexpr double kReferencePeriod_px = 64.0;

struct ReferenceProjector {
  std::size_t projector = 0;  ///< Index in the installation.
  int width_px = 0;
  int height_px = 0;
};

/// Expected pixel of a reference projector for each camera pixel. Both images have the camera's size.
struct ExpectedReferences {
  Image<float, 2> pixel_px;
  Image<std::int16_t, 1> reference;  ///< Index of the reference projector; -1: none, more than one, or not used.
};

struct ReferenceView {
  std::vector<solve::Correspondence> correspondences;  ///< `projector` is an index into the references.
  int pictures = 0;
};

/// Measures the references. Precondition: all projectors are dark; they are dark again on return. The search for the
/// exposure begins at `exposure_s`. Errors: those of measure_view(). Blocks.
Result<ReferenceView> measure_references(const std::vector<ReferenceProjector>& references,
                                         const ExpectedReferences& expected, double exposure_s,
                                         const structured_light::ExposureLimits& limits, PatternScreen& screen,
                                         ScanCamera& camera, const PhotographListener& listener, std::stop_token stop);

}  // namespace cyclorama::scan
