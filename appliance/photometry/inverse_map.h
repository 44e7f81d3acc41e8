// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "appliance/calibration/direction_chart.h"
#include "appliance/calibration/measured_map.h"
#include "common/base/result.h"

namespace cyclorama::photometry {

/// Exact inverse of MeasuredMap::direction_at(): maps a direction to a projector's pixel. Reentrant.
class InverseMap {
 public:
  /// Inverts a map. Errors: kInvalidArgument if the map has no directions, its counts are inconsistent, or it surrounds
  /// the sweet spot.
  static Result<InverseMap> make(const calibration::MeasuredMap& map);

  /// Returns the pixel of a direction of unit length; nothing if the projector's picture does not cover it.
  [[nodiscard]] std::optional<Eigen::Vector2d> pixel_at(const Eigen::Vector3d& direction) const;

 private:
  struct Triangle {
    Eigen::Matrix3d shares;  ///< Matrix from a direction to its barycentric coordinates.
    Eigen::Matrix<double, 2, 3> corners_px;
  };
  InverseMap(const calibration::MeasuredMap& map, const calibration::DirectionChart& chart);
  void add(const calibration::MeasuredMap& map, const std::array<int, 3>& nodes);
  [[nodiscard]] Eigen::Vector2i bin_of(const Eigen::Vector2d& position) const;

  calibration::DirectionChart chart_;
  Eigen::Vector2d low_ = Eigen::Vector2d::Zero();
  double bins_per_rad_ = 1.0;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<Triangle> triangles_;
  std::vector<std::vector<int>> bins_;
};

}  // namespace cyclorama::photometry
