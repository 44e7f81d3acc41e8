// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "appliance/calibration/brown_model.h"
#include "appliance/calibration/lens_model.h"
#include "appliance/camera_calibration/board_view.h"
#include "common/base/result.h"
#include "common/geometry/frames.h"
#include "common/geometry/rigid_transform.h"

namespace cyclorama::camera_calibration {

struct ImageSize {
  int width_px = 0;
  int height_px = 0;
};

inline constexpr int kMaxStarts = 3;

/// What a board is like: paper is seldom as flat, or as square, as it was printed.
enum class BoardModel {
  kFlat,
  kBent,  ///< Stretched along y, and bent to second order; the same in all views.
};
struct BoardShape {
  double stretch = 0.0;  ///< y is this share longer than it should be.
  /// z = bend_xx x² + bend_xy x y + bend_yy y²; per metre, in the board's frame.
  double bend_xx = 0.0;
  double bend_xy = 0.0;
  double bend_yy = 0.0;
};
inline constexpr int kBoardValues = 4;

/// What is to be solved, and how freely.
struct ProcamChoice {
  ImageSize camera;
  ImageSize projector;
  calibration::LensModel camera_model = calibration::LensModel::kRadial1;
  calibration::LensModel projector_model = calibration::LensModel::kRadial1;
  BoardModel board_model = BoardModel::kFlat;
  int starts = kMaxStarts;  ///< Starting points to try, 1 to kMaxStarts.
};

/// A camera and a projector, and where they stand to each other.
struct ProcamCalibration {
  calibration::BrownParameters camera;
  calibration::BrownParameters projector;
  calibration::BrownBlock camera_sigma = {};  ///< One deviation of each value, from the residuals; 0 of what was held.
  calibration::BrownBlock projector_sigma = {};
  RigidTransform<frame::Projector, frame::Camera> T_projector_camera;
  BoardShape board;
  std::vector<RigidTransform<frame::Camera, frame::Board>> T_camera_board;  ///< One per view.
  double camera_rms_px = 0.0;  ///< Root of the mean squared distance, of all corners.
  double projector_rms_px = 0.0;
  double stereo_rms_px = 0.0;  ///< Of both together, as OpenCV's stereoCalibrate() has it.
  int unknowns = 0;
  int rank = 0;             ///< Equal to the unknowns, or there would be no answer.
  int starts_agreeing = 0;  ///< Of the starting points, those that led to the same place.
};

/// One bundle adjustment of everything: lenses, the two devices' places, and each board's. Starting points are found
/// from the views alone. The gauge is the camera's frame; the board's size gives the scale. Reentrant.
///
/// kInvalidArgument  no views, lists of different lengths, fewer than 8 corners, numbers that are not finite, or a
/// board
///                   with no size.
/// kBadData          the views do not determine it: says what to add.
Result<ProcamCalibration> solve_procam(const std::vector<BoardView>& views, const ProcamChoice& choice);

/// How well a calibration predicts a view that it has not seen.
struct HeldOut {
  double camera_rms_px = 0.0;     ///< Of the corners that place the board: six numbers are fitted to them.
  double projector_rms_px = 0.0;  ///< Of the corners on the projector, predicted with nothing fitted.
  double stereo_rms_px = 0.0;     ///< Of both, when both place the board, as stereo_rms_px above.
};
/// Errors as solve_procam().
Result<HeldOut> held_out(const BoardView& view, const ProcamCalibration& calibration);

}  // namespace cyclorama::camera_calibration
