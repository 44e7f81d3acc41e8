// SPDX-License-Identifier: Apache-2.0
/// Computes a camera's lens from pictures of a board: selects distinct views and the smallest model that predicts
/// left-out views well, and reports which views to add if they do not suffice.
#pragma once

#include <string>
#include <vector>

#include "appliance/camera_calibration/lens_solve.h"

namespace cyclorama::camera_calibration {

struct LensTrial {
  calibration::LensModel model = calibration::LensModel::kPinhole;
  double training_rms_px = 0.0;  ///< For information only; not used to choose.
  double heldout_rms_px = 0.0;   ///< Infinite if a fold did not determine the lens.
};

struct LensSelection {
  LensFit fit;
  calibration::LensModel model = calibration::LensModel::kPinhole;
  double heldout_rms_px = 0.0;
  double worst_sigma_px = 0.0;  ///< Largest standard deviation of a direction, over the picture.
  std::vector<LensTrial> trials;
  std::vector<std::string> used;     ///< Names of the views that were used.
  std::vector<std::string> remarks;  ///< Views that were left out, and possible improvements.
};

/// Returns true if `view` shows the board in a different position or orientation than all of `others`: their common
/// corners are more than a fiftieth of the picture's diagonal apart on average, or too few corners are common.
/// Reentrant.
[[nodiscard]] bool is_new_view(const LensView& view, const std::vector<LensView>& others, int width_px, int height_px);

inline constexpr std::size_t kMinViews = 5;

/// Leaves out views that do not belong to the others, with a remark: the lens of all others predicts them far worse
/// than those are predicted. Then fits the models pinhole, k1, k1 k2, k1 k2 p1 p2 and k1 k2 p1 p2 k3, and chooses the smallest one whose error on
/// left-out views is within 4 % of the best model's.
///
/// Errors: kInvalidArgument for the reasons of solve_lens(); kBadData, with the remedy, if fewer than kMinViews views
/// differ, or the views do not determine the focal length or a part of the picture. Reentrant.
Result<LensSelection> select_lens(const std::vector<LensView>& views, int width_px, int height_px);

}  // namespace cyclorama::camera_calibration
