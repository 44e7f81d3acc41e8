// SPDX-License-Identifier: Apache-2.0
/// The settings between which a governor chooses: each the best picture for what it costs.
#pragma once

#include <span>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/render/picture_quality.h"

namespace cyclorama {

struct FrontPoint {
  PictureQuality quality;
  double cost = 1.0;   ///< Of a shown pixel, in any unit: only ratios count.
  double error = 1.0;  ///< Against the reference; in one measure for the whole front.
};

/// A Pareto front: costs grow from point to point and errors fall. A value, never empty.
class Front {
 public:
  /// Points that cost as much as a better one, or more, are left out. kInvalidArgument  no points, a quality out of
  /// range, a cost that is not above zero or an error below zero.
  static Result<Front> make(std::vector<FrontPoint> points);
  /// For scenes that have not been measured.
  static Front standard();

  [[nodiscard]] std::size_t size() const { return points_.size(); }
  [[nodiscard]] const FrontPoint& operator[](std::size_t i) const { return points_[i]; }
  [[nodiscard]] const FrontPoint& best() const { return points_.back(); }

 private:
  explicit Front(std::vector<FrontPoint> points) : points_(std::move(points)) {}
  std::vector<FrontPoint> points_;
};

}  // namespace cyclorama
