// SPDX-License-Identifier: Apache-2.0
/// A camera's lens from pictures of a board: which pictures count, the least model that predicts those left out, and
/// what to add when they do not tell enough.
#pragma once

#include <string>
#include <vector>

#include "appliance/camera_calibration/lens_solve.h"

namespace cyclorama::camera_calibration {

struct LensTrial {
  calibration::LensModel model = calibration::LensModel::kPinhole;
  double training_rms_px = 0.0;  ///< Told, never used to choose.
  double heldout_rms_px = 0.0;   ///< Infinite when a fold did not determine it.
};

struct LensSelection {
  LensFit fit;
  calibration::LensModel model = calibration::LensModel::kPinhole;
  double heldout_rms_px = 0.0;
  double worst_sigma_px = 0.0;  ///< Of a direction, in pixels, where in the picture the lens is known least.
  std::vector<LensTrial> trials;
  std::vector<std::string> used;     ///< Names of the views that counted.
  std::vector<std::string> remarks;  ///< What would make it better.
};

/// Whether `view` shows the board elsewhere, or turned, than all of `others`: corners that both see moved by more than
/// a fiftieth of the picture's diagonal in the mean, or there are too few of them. Reentrant.
[[nodiscard]] bool is_new_view(const LensView& view, const std::vector<LensView>& others, int width_px, int height_px);

inline constexpr std::size_t kMinViews = 5;

/// Climbs pinhole, k1, k1 k2, k1 k2 p1 p2, and with k3; of all, the least whose error on left-out views is within 4 %
/// of the best.
///
/// kInvalidArgument  as solve_lens().
/// kBadData          fewer than kMinViews views that differ, or they leave the focal length or a part of the picture
///                   unknown: says what to add.
/// Reentrant.
Result<LensSelection> select_lens(const std::vector<LensView>& views, int width_px, int height_px);

}  // namespace cyclorama::camera_calibration
