// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>

#include "appliance/calibration/calibration.h"

namespace cyclorama::calibration {

/// Returns a calibration of two projectors, one control point of which is not on the wall.
inline Calibration small_calibration(const std::string& date) {
  Calibration calibration;
  calibration.date = date;
  calibration.turntable.camera = MeasuredLens::from_focal(1920, 1200, 1400.0);
  calibration.turntable.angles_rad = {-0.5, 0.0, 0.5};
  calibration.turntable.reference = 1;
  calibration.turntable.inverse_depth[0] = 0.25;
  calibration.turntable.offset_reason = "not needed";
  calibration.turntable.parameters = {"pitch_rad", "roll_rad"};
  calibration.turntable.covariance = 1e-6 * Eigen::Matrix2d::Identity();
  calibration.turntable.heldout_rms_px = 0.1;
  for (const char* name : {"left", "right"}) {
    MeasuredMap map{1920, 1080, 2, 1, {}, {}, 0.2, 0.1, 500};
    for (int i = 0; i < 6; ++i) map.directions.push_back(Eigen::Vector3d(0.1 * i, 0.05, -1.0).normalized());
    map.sigma_px.assign(6, 0.05);
    map.directions[3].setConstant(std::numeric_limits<double>::quiet_NaN());
    map.sigma_px[3] = std::numeric_limits<double>::infinity();
    calibration.projectors.push_back({name, map, false});
  }
  ModelChoice wall;
  wall.fit.surface.model = SurfaceModel::kCylinder;
  wall.fit.surface.parameters = {0.01, 0.02, 0.03, 0.25};
  wall.fit.surface_sigmas = {1e-3, 1e-3, 1e-3, 1e-3};
  wall.fit.projectors.resize(2);
  for (FittedProjector& p : wall.fit.projectors) {
    p.lens = MeasuredLens::from_focal(1920, 1080, 2000.0);
    p.T_eye_projector = {Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0), {0.5, 1.0, 0.2}};
  }
  wall.surfaces = {{"plane", 2, 3.0, 3.1, 0.01, true}, {"cylinder", 4, 0.1, 0.11, 0.001, true}};
  wall.reason = "the least that predicts";
  calibration.wall = wall;
  calibration.remarks = {"darken the room"};
  return calibration;
}

}  // namespace cyclorama::calibration
