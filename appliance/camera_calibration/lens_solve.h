// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "appliance/calibration/measured_lens.h"
#include "appliance/camera_calibration/lens_view.h"
#include "common/base/result.h"

namespace cyclorama::camera_calibration {

/// Result of solve_lens().
struct LensFit {
  calibration::MeasuredLens lens;  ///< The covariance follows from the scatter of the corners.
  double rms_px = 0.0;             ///< Per axis, without the worst twentieth.
  int rank = 0;     ///< Number of lens parameters that the pictures determine better than a data sheet would.
  int freedom = 0;  ///< Number of free lens parameters.
};

/// Fits a lens of `model` (with square pixels) and each board's pose by one robust bundle adjustment. The search starts
/// at `focal_px` if that is given, otherwise at three focal lengths. Reentrant.
///
/// Errors: kInvalidArgument if there are no views, a view has fewer than 8 corners or only collinear ones, or a number
/// is not finite; kBadData, with the remedy, if the views do not determine the lens.
Result<LensFit> solve_lens(const std::vector<LensView>& views, int width_px, int height_px,
                           calibration::LensModel model, std::optional<double> focal_px = std::nullopt);

/// Returns the prediction error, RMS per axis without the worst twentieth, for a view that was not used in the fit:
/// every second corner determines the board's pose, and the remaining corners are predicted. Errors: those of
/// solve_lens().
Result<double> prediction_error_px(const LensView& view, const calibration::MeasuredLens& lens);

}  // namespace cyclorama::camera_calibration
