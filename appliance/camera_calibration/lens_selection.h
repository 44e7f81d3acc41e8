// SPDX-License-Identifier: Apache-2.0
/// A camera's lens from pictures of a board: selects the views that count and the smallest model that predicts left-out
/// views, and reports what to add if the views do not suffice.
#pragma once

#include <string>
#include <vector>

#include "appliance/camera_calibration/lens_solve.h"

namespace cyclorama::camera_calibration {

struct LensTrial {
  calibration::LensModel model = calibration::LensModel::kPinhole;
  double training_rms_px = 0.0;  ///< For information; never used to choose.
  double heldout_rms_px = 0.0;   ///< Infinite if a fold did not determine the lens.
};

struct LensSelection {
  LensFit fit;
  calibration::LensModel model = calibration::LensModel::kPinhole;
  double heldout_rms_px = 0.0;
  double worst_sigma_px = 0.0;  ///< Largest standard deviation of a direction over the picture, in pixels.
  std::vector<LensTrial> trials;
  std::vector<std::string> used;     ///< Names of the views that were used.
  std::vector<std::string> remarks;  ///< Possible improvements.
};

/// Returns true if `view` shows the board in a different position or orientation than all of `others`: their common
/// corners moved on average by more than a fiftieth of the picture's diagonal, or there are too few of them. Reentrant.
[[nodiscard]] bool is_new_view(const LensView& view, const std::vector<LensView>& others, int width_px, int height_px);

inline constexpr std::size_t kMinViews = 5;

/// Tries pinhole, k1, k1 k2, k1 k2 p1 p2, and with k3, and chooses the smallest model whose error on left-out views is
/// within 4 % of the best.
///
/// Errors: kInvalidArgument as solve_lens(); kBadData, with the remedy, if fewer than kMinViews views differ or they
/// leave the focal length or a part of the picture undetermined. Reentrant.
Result<LensSelection> select_lens(const std::vector<LensView>& views, int width_px, int height_px);

}  // namespace cyclorama::camera_calibration
