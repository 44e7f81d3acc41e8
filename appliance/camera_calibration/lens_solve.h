// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "appliance/calibration/measured_lens.h"
#include "appliance/camera_calibration/lens_view.h"
#include "common/base/result.h"

namespace cyclorama::camera_calibration {

/// A lens, and where the boards were.
struct LensFit {
  calibration::MeasuredLens lens;  ///< With its covariance, from the corners' own scatter.
  double rms_px = 0.0;             ///< Per axis, without the worst twentieth.
  int rank = 0;     ///< Of the lens's numbers, those that the pictures tell better than a data sheet would.
  int freedom = 0;  ///< How many numbers of the lens were looked for.
};

/// One bundle adjustment of a lens of this model (square pixels) and of each board's place. Robust: a corner that was
/// found wrongly pulls little. Where the focal length is about known (`focal_px`) the search begins there alone, else
/// at three places. Reentrant.
///
/// kInvalidArgument  no views, one with fewer than 8 corners or all on a line, or numbers that are not finite.
/// kBadData          the views do not determine it: says what to add.
Result<LensFit> solve_lens(const std::vector<LensView>& views, int width_px, int height_px,
                           calibration::LensModel model, std::optional<double> focal_px = std::nullopt);

/// Per axis, without the worst twentieth, of a view that the lens has not seen: every second corner places the board,
/// the others are predicted. Errors as solve_lens().
Result<double> prediction_error_px(const LensView& view, const calibration::MeasuredLens& lens);

}  // namespace cyclorama::camera_calibration
