// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "appliance/camera_calibration/procam_solve.h"

namespace cyclorama::camera_calibration {

/// Models of both lenses and of the board, and what they predict.
struct ProcamCandidate {
  calibration::LensModel camera = calibration::LensModel::kPinhole;
  calibration::LensModel projector = calibration::LensModel::kPinhole;
  BoardModel board = BoardModel::kFlat;
  int freedom = 0;               ///< Numbers that lenses and board leave free.
  double training_rms_px = 0.0;  ///< Stereo, of all views; never what a model is chosen by.
  double heldout_rms_px =
      0.0;  ///< Over all left-out views, HeldOut::stereo_rms_px; infinite when one was not determined.
  double prediction_rms_px = 0.0;   ///< Likewise, HeldOut::projector_rms_px: nothing of the projector is fitted.
  double centre_scatter_px = 0.0;   ///< How far apart the left-out views put the projector's centre, at most.
  std::vector<HeldOut> folds = {};  ///< By the view left out.
};

struct ProcamSelection {
  std::vector<ProcamCandidate> models;
  std::size_t chosen = 0;         ///< Of models.
  ProcamCalibration calibration;  ///< With it, of all views.
};

/// Climbs twice, with a flat board and with a bent one: from the least lenses, always to that model one or two models
/// richer in one lens which predicts left-out views best, as long as that is gain it. Of all that were tried, the
/// least that predicts about as well as the best is taken.
///
/// Errors as solve_procam(); kBadData also with fewer than three views, for then there is nothing to leave out.
Result<ProcamSelection> select_procam_model(const std::vector<BoardView>& views, ImageSize camera, ImageSize projector);

}  // namespace cyclorama::camera_calibration
