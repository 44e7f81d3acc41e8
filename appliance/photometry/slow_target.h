// SPDX-License-Identifier: Apache-2.0
/// Computes the largest target brightness that varies too slowly to be noticed.
///
///   light   ╭──╮  achievable luminance                the largest target below it whose relative slope is bounded is
///          ╱ ╭──╲───╮                                 its lower envelope of cones:
///         ╱ ╱    ╰─╲ ╲                                  log target(d) = min over e of
///        ╱ ╱ target  ╰╲                                                 log achievable(e) + slope * angle(d, e)
///                                                     It is the largest in every direction.
///   Source: Majumder and Stevens, "Perceptual photometric seamlessness in projection-based tiled displays", ACM Trans.
///   Graph. 24 (1), 2005: they solve the same problem by dynamic programming on pixels.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <vector>

#include "appliance/calibration/direction_chart.h"
#include "appliance/photometry/photometry_input.h"
#include "common/base/result.h"

namespace cyclorama::photometry {

/// Positive scalar field over directions, on a grid that covers all lit directions. A value; reentrant.
class DirectionField {
 public:
  /// Creates a grid over all directions of the maps, with a margin; the step is `step_rad`, or wider if there would be
  /// too many grid points. Errors: kInvalidArgument if the maps have no directions or surround the sweet spot in every
  /// direction.
  static Result<DirectionField> over(const std::vector<PhotometricProjector>& projectors, double step_rad);

  /// Sets each grid point to `value` of its direction; an infinite value means no bound.
  void fill(const std::function<double(const Eigen::Vector3d&)>& value);
  /// Returns the largest field that is nowhere above this one and whose logarithm changes by at most `slope_per_rad`,
  /// smoothed over `blur_rad`. The smoothing lowers the logarithm by at most slope * blur. Points without a bound are
  /// bounded by their neighbours. Precondition: at least one point has a bound, and all bounds are above 0.
  [[nodiscard]] DirectionField slow_below(double slope_per_rad, double blur_rad) const;
  /// Does the same with one slope per grid point, in the order of positions(); between two points the mean of their
  /// slopes applies.
  [[nodiscard]] DirectionField slow_below(const std::vector<double>& slopes_per_rad, double blur_rad) const;
  /// Returns, per grid point, whether it is within about `radius_rad` of a border between two different nonzero values
  /// of `label`.
  [[nodiscard]] std::vector<bool> near_borders(const std::function<unsigned(const Eigen::Vector3d&)>& label,
                                               double radius_rad) const;

  /// Returns the value in a direction; its logarithm is interpolated bilinearly.
  [[nodiscard]] double at(const Eigen::Vector3d& direction) const;
  /// Solid angle in steradians and value of one grid point.
  struct Place {
    double area_sr = 0.0;
    double value = 0.0;
  };
  [[nodiscard]] std::vector<Place> positions() const;

 private:
  DirectionField(const calibration::DirectionChart& chart, const Eigen::Vector2d& low, double step, int columns,
                 int rows);
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x);
  }
  void sweep_cones(const std::vector<double>& slopes_per_rad);
  void blur(double sigma_cells);

  calibration::DirectionChart chart_;
  Eigen::Vector2d low_;
  double step_rad_;
  int columns_;
  int rows_;
  std::vector<Eigen::Vector3d> directions_;
  std::vector<double> logs_;
};

}  // namespace cyclorama::photometry
