// SPDX-License-Identifier: Apache-2.0
/// An error-free calibration of an installation, with an optional rotation.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <string>

#include "appliance/solve/calibrate.h"
#include "appliance/warp/projector_map.h"

namespace cyclorama {

/// Every projector's light lies `turned_rad` farther to the right than in the installation.
inline calibration::Calibration exact_calibration(const Installation& room, const std::string& date,
                                                  double turned_rad = 0.0) {
  calibration::Calibration calibration;
  calibration.date = date;
  calibration.turntable.camera = calibration::MeasuredLens::from_focal(1920, 1200, 1400.0);
  calibration.turntable.angles_rad = {0.0};
  calibration.turntable.offset_reason = "not needed";
  const Eigen::AngleAxisd turn(-turned_rad, Eigen::Vector3d::UnitY());
  for (std::size_t i = 0; i < room.projectors.size(); ++i) {
    const Pinhole& lens = room.projectors[i].lens;
    const warp::ProjectorMap exact(room, i);
    calibration::MeasuredMap map{
        lens.width_px, lens.height_px, lens.width_px / 4, lens.height_px / 4, {}, {}, 0.01, 0.1, 1000};
    for (int y = 0; y <= map.cells_y; ++y) {
      for (int x = 0; x <= map.cells_x; ++x) {
        const auto view = exact.view_direction_of({static_cast<double>(x) * lens.width_px / map.cells_x,
                                                   static_cast<double>(y) * lens.height_px / map.cells_y});
        map.directions.push_back(view ? turn * view->normalized()
                                      : Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()).eval());
        map.sigma_px.push_back(view ? 0.05 : std::numeric_limits<double>::infinity());
      }
    }
    calibration.projectors.push_back({room.projectors[i].name, std::move(map), false});
  }
  return calibration;
}

}  // namespace cyclorama
