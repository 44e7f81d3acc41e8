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

/// Model of the board's shape: printed paper is seldom perfectly flat or square.
enum class BoardModel {
  kFlat,
  kBent,  ///< Stretched along y, and bent to second order; the same in all views.
};
struct BoardShape {
  double stretch = 0.0;  ///< Relative elongation along y.
  /// z = bend_xx x² + bend_xy x y + bend_yy y² in the board's frame; in 1/m.
  double bend_xx = 0.0;
  double bend_xy = 0.0;
  double bend_yy = 0.0;
};
inline constexpr int kBoardValues = 4;

/// Models to fit, and the pictures' sizes.
struct ProcamChoice {
  ImageSize camera;
  ImageSize projector;
  calibration::LensModel camera_model = calibration::LensModel::kRadial1;
  calibration::LensModel projector_model = calibration::LensModel::kRadial1;
  BoardModel board_model = BoardModel::kFlat;
  int starts = kMaxStarts;  ///< Number of starting points to try, 1 to kMaxStarts.
};

/// Intrinsics of a camera and a projector, and their relative pose.
struct ProcamCalibration {
  calibration::BrownParameters camera;
  calibration::BrownParameters projector;
  /// Standard deviation of each parameter, from the residuals; 0 for parameters that were not free.
  calibration::BrownBlock camera_sigma = {};
  calibration::BrownBlock projector_sigma = {};
  RigidTransform<frame::Projector, frame::Camera> T_projector_camera;
  BoardShape board;
  std::vector<RigidTransform<frame::Camera, frame::Board>> T_camera_board;  ///< One per view.
  double camera_rms_px = 0.0;  ///< Root mean square distance over all corners.
  double projector_rms_px = 0.0;
  double stereo_rms_px = 0.0;  ///< Over both devices, as OpenCV's stereoCalibrate() defines it.
  int unknowns = 0;
  int rank = 0;             ///< Equal to `unknowns`, since solve_procam() fails otherwise.
  int starts_agreeing = 0;  ///< Number of starting points that converged to the same solution.
};

/// Fits both lenses, their relative pose and each board's pose by one bundle adjustment. The starting points are
/// computed from the views alone. The camera's frame is the gauge; the board's size gives the scale. Reentrant.
///
/// Errors: kInvalidArgument if there are no views, lists of different lengths, fewer than 8 corners, a number that is
/// not finite, or a board without size; kBadData, with the remedy, if the views do not determine the solution.
Result<ProcamCalibration> solve_procam(const std::vector<BoardView>& views, const ProcamChoice& choice);

/// Prediction errors of a calibration for a view that was not used in its fit.
struct HeldOut {
  /// Over the camera's corners, to which the board's pose is fitted.
  double camera_rms_px = 0.0;
  double projector_rms_px = 0.0;  ///< Over the projector's corners, predicted without a fit to them.
  double stereo_rms_px = 0.0;     ///< Over all corners, with the board's pose fitted to all.
};
/// Returns the prediction errors of a calibration for a view. Errors: those of solve_procam().
Result<HeldOut> held_out(const BoardView& view, const ProcamCalibration& calibration);

}  // namespace cyclorama::camera_calibration
