// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "appliance/camera_calibration/procam_solve.h"

namespace cyclorama::camera_calibration {

/// One combination of models of both lenses and of the board, with its prediction errors.
struct ProcamCandidate {
  calibration::LensModel camera = calibration::LensModel::kPinhole;
  calibration::LensModel projector = calibration::LensModel::kPinhole;
  BoardModel board = BoardModel::kFlat;
  int freedom = 0;               ///< Number of free parameters of lenses and board.
  double training_rms_px = 0.0;  ///< Stereo, over all views; for information, never used to choose.
  double heldout_rms_px =
      0.0;  ///< HeldOut::stereo_rms_px over all left-out views; infinite if a fold was undetermined.
  /// HeldOut::projector_rms_px over all left-out views; nothing of the projector is fitted.
  double prediction_rms_px = 0.0;
  double centre_scatter_px = 0.0;   ///< Largest distance between the projector centres of the folds.
  std::vector<HeldOut> folds = {};  ///< One per view left out.
};

struct ProcamSelection {
  std::vector<ProcamCandidate> models;
  std::size_t chosen = 0;         ///< Index in `models`.
  ProcamCalibration calibration;  ///< The chosen model fitted to all views.
};

/// Forward selection, once with a flat and once with a bent board: from the smallest lenses, moves to the best of the
/// models that are one or two steps richer in one lens, as long as left-out views are predicted better by a sufficient
/// gain. Of all candidates tried, chooses the smallest that predicts about as well as the best.
///
/// Errors: those of solve_procam(); kBadData also for fewer than three views, which leave nothing to leave out.
Result<ProcamSelection> select_procam_model(const std::vector<BoardView>& views, ImageSize camera, ImageSize projector);

}  // namespace cyclorama::camera_calibration
