// SPDX-License-Identifier: Apache-2.0
/// An error-free calibration of a simulated museum, for tests of later steps. Contains the truth.
#pragma once

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "appliance/solve/calibrate.h"
#include "drivers/simulated/museum/true_museum.h"

namespace cyclorama {

inline calibration::MeasuredMap true_map(const simulated::TrueMuseum& museum, std::size_t projector) {
  const Pinhole& lens = museum.truth().projectors[projector].lens.pinhole();
  calibration::MeasuredMap map{
      lens.width_px, lens.height_px, lens.width_px / 16, lens.height_px / 16, {}, {}, 0.01, 0.1, 1000};
  for (int y = 0; y <= map.cells_y; ++y) {
    for (int x = 0; x <= map.cells_x; ++x) {
      const auto view =
          museum.direction_at(projector, static_cast<double>(x) * lens.width_px / map.cells_x,
                              static_cast<double>(y) * lens.height_px / map.cells_y, museum.installation().sweet_spot);
      map.directions.push_back(view ? *view
                                    : Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()).eval());
      map.sigma_px.push_back(view ? 0.05 : std::numeric_limits<double>::infinity());
    }
  }
  return map;
}

inline calibration::Calibration true_calibration(const simulated::TrueMuseum& museum, const std::string& date) {
  calibration::Calibration calibration;
  calibration.date = date;
  calibration.turntable.camera = calibration::MeasuredLens::from_focal(1920, 1200, 1400.0);
  calibration.turntable.angles_rad = {0.0};
  calibration.turntable.offset_reason = "not needed";
  for (std::size_t i = 0; i < museum.truth().projectors.size(); ++i)
    calibration.projectors.push_back({museum.installation().projectors[i].name, true_map(museum, i), false});
  return calibration;
}

/// Returns the true error of a projector's map: 95th percentile over its pixels, in pixels.
inline double map_off_px(const simulated::TrueMuseum& museum, std::size_t projector,
                         const calibration::MeasuredMap& map) {
  constexpr int kSide = 16;
  std::vector<double> errors;
  for (int i = 0; i < kSide * kSide; ++i) {
    const Eigen::Vector2d pixel((i % kSide + 0.5) / kSide * map.width_px, (i / kSide + 0.5) / kSide * map.height_px);
    const Point<frame::Room>& eye = museum.installation().sweet_spot;
    const auto lands = museum.direction_at(projector, pixel.x(), pixel.y(), eye);
    const auto beside = museum.direction_at(projector, pixel.x() + 1.0, pixel.y(), eye);
    const auto told = map.direction_at(pixel);
    if (!lands || !beside || !told) continue;
    errors.push_back((*told - *lands).norm() / (*beside - *lands).norm());
  }
  if (errors.empty()) return 1e3;
  std::ranges::sort(errors);
  return errors[errors.size() * 95 / 100];
}

}  // namespace cyclorama
