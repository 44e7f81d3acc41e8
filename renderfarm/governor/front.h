// SPDX-License-Identifier: Apache-2.0
/// The Pareto front of settings among which a governor chooses: each is the best picture for its cost.
#pragma once

#include <span>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/render/picture_quality.h"

namespace cyclorama::governor {

struct ParetoPoint {
  render::PictureQuality quality;
  double cost = 1.0;   ///< Per displayed pixel, in any unit; only ratios matter.
  double error = 1.0;  ///< Against the reference; the same measure for the whole front.
};

/// A Pareto front: costs increase from point to point and errors decrease. A value, never empty.
class ParetoFront {
 public:
  /// Omits points that cost as much as a better one or more. Errors: kInvalidArgument if there are no points, if a
  /// quality is out of range, or unless costs are above zero and errors at least zero.
  static Result<ParetoFront> make(std::vector<ParetoPoint> points);
  /// Returns the Pareto front for scenes that have not been measured.
  static ParetoFront standard();

  [[nodiscard]] std::size_t size() const { return points_.size(); }
  [[nodiscard]] const ParetoPoint& operator[](std::size_t i) const { return points_[i]; }
  [[nodiscard]] const ParetoPoint& best() const { return points_.back(); }

 private:
  explicit ParetoFront(std::vector<ParetoPoint> points) : points_(std::move(points)) {}
  std::vector<ParetoPoint> points_;
};

}  // namespace cyclorama::governor
