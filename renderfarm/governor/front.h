// SPDX-License-Identifier: Apache-2.0
/// The Pareto front of settings from which a governor chooses: each point is the best picture for its cost.
#pragma once

#include <span>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/render/picture_quality.h"

namespace cyclorama::governor {

/// Number of bounces in scenes that do not state one.
inline constexpr int kStandardBounces = 4;

struct ParetoPoint {
  render::PictureQuality quality;
  double cost = 1.0;   ///< Cost per displayed pixel, in any unit; only ratios matter.
  double error = 1.0;  ///< Error against the reference, by one measure for the whole front.
};

/// A Pareto front: costs increase from point to point and errors decrease. A value, never empty.
class ParetoFront {
 public:
  /// Omits points that cost as much as a better point or more. Errors: kInvalidArgument if there are no points, a
  /// quality is out of range, a cost is not above zero, or an error is below zero.
  static Result<ParetoFront> make(std::vector<ParetoPoint> points);
  /// Returns the Pareto front for scenes that have not been measured. All its points have the same bounces, so that the
  /// picture's brightness does not depend on its quality. Precondition: 0 <= bounces <= kMaxBounces.
  static ParetoFront standard(int bounces = kStandardBounces);

  [[nodiscard]] std::size_t size() const { return points_.size(); }
  [[nodiscard]] const ParetoPoint& operator[](std::size_t i) const { return points_[i]; }
  [[nodiscard]] const ParetoPoint& best() const { return points_.back(); }
  /// Returns the picture of about this cost, interpolated between points if necessary. From one point to the next, the
  /// number of rendered pixels changes linearly with the cost, and the samples use the rest of it. Samples are whole
  /// numbers: they are rounded up if the scale can then be at least 0.7, otherwise down, and the scale compensates for
  /// the rounding. Other settings are those of the point that is better at this cost, where the error of the more
  /// expensive point is assumed to be inversely proportional to the cost. Below the first and beyond the last point,
  /// returns that point.
  [[nodiscard]] ParetoPoint at(double cost) const;

 private:
  explicit ParetoFront(std::vector<ParetoPoint> points) : points_(std::move(points)) {}
  std::vector<ParetoPoint> points_;
};

}  // namespace cyclorama::governor
