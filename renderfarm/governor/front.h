// SPDX-License-Identifier: Apache-2.0
/// The Pareto front of settings among which a governor chooses: each is the best picture for its cost.
#pragma once

#include <span>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/render/picture_quality.h"

namespace cyclorama::governor {

/// Bounces in scenes that do not state their own.
inline constexpr int kStandardBounces = 4;

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
  /// Returns the Pareto front for scenes that have not been measured. All its points have the same bounces, so that the
  /// picture's brightness does not depend on its quality. Precondition: 0 <= bounces <= kMaxBounces.
  static ParetoFront standard(int bounces = kStandardBounces);

  [[nodiscard]] std::size_t size() const { return points_.size(); }
  [[nodiscard]] const ParetoPoint& operator[](std::size_t i) const { return points_[i]; }
  [[nodiscard]] const ParetoPoint& best() const { return points_.back(); }
  /// Returns the picture of about that cost, between the points where necessary. From one point to the next, the rendered
  /// pixels change linearly with the cost, and the samples as the rest affords. The scale makes up for samples being
  /// whole numbers: they are rounded up where that leaves a scale of 0.7, and down otherwise. Other settings are those of
  /// the cheaper point until the dearer one, with its error inversely proportional to its cost, is better. Below the
  /// first point and beyond the last one, returns these.
  [[nodiscard]] ParetoPoint at(double cost) const;

 private:
  explicit ParetoFront(std::vector<ParetoPoint> points) : points_(std::move(points)) {}
  std::vector<ParetoPoint> points_;
};

}  // namespace cyclorama::governor
