// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "appliance/camera_calibration/procam_solve.h"

namespace cyclorama::camera_calibration {

/// Combination of models of both lenses and of the board, with its prediction errors.
struct ProcamCandidate {
  calibration::LensModel camera = calibration::LensModel::kPinhole;
  calibration::LensModel projector = calibration::LensModel::kPinhole;
  BoardModel board = BoardModel::kFlat;
  int freedom = 0;               ///< Number of free parameters of lenses and board.
  double training_rms_px = 0.0;  ///< Stereo, over all views; for information only.
  double heldout_rms_px = 0.0;   ///< HeldOut::stereo_rms_px over all folds; infinite if one has no solution.
  /// HeldOut::projector_rms_px over all folds: a prediction without any fit to the projector.
  double prediction_rms_px = 0.0;
  double centre_scatter_px = 0.0;   ///< Largest distance between the projector centres of the folds.
  std::vector<HeldOut> folds = {};  ///< One per view, each of which one fit left out.
};

struct ProcamSelection {
  std::vector<ProcamCandidate> models;
  std::size_t chosen = 0;         ///< Index in `models`.
  ProcamCalibration calibration;  ///< Chosen model, fitted to all views.
};

/// Selects the models by forward selection, once with a flat and once with a bent board. Starting with the smallest
/// lenses, each step takes the best of the models that are one or two steps richer in one lens, as long as the error on
/// left-out views decreases sufficiently. Of all models tried, chooses the smallest that predicts about as well as the
/// best.
///
/// Errors: those of solve_procam(); kBadData also for fewer than three views, too few for leaving one out.
Result<ProcamSelection> select_procam_model(const std::vector<BoardView>& views, ImageSize camera, ImageSize projector);

}  // namespace cyclorama::camera_calibration
