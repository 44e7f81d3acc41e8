// SPDX-License-Identifier: Apache-2.0
/// Brightness that varies so slowly that nobody notices, and wastes as little light as that allows.
///
///   light   ╭──╮  what can be reached                 the largest target below it whose relative slope is bounded is
///          ╱ ╭──╲───╮                                 its lower envelope of cones:
///         ╱ ╱    ╰─╲ ╲                                  log target(d) = min over e of log reach(e) + slope * angle(d,
///         e)
///        ╱ ╱ target  ╰╲                               It is the largest at every place, so also in sum.
///   Source: Majumder and Stevens, "Perceptual photometric seamlessness in projection-based tiled displays", ACM Trans.
///   Graph. 24 (1), 2005: the same bound and aim, there by dynamic programming on pixels.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <vector>

#include "appliance/calibration/direction_chart.h"
#include "appliance/photometry/photometry_input.h"
#include "common/base/result.h"

namespace cyclorama::photometry {

/// A positive number for each direction, on a grid over all that the projectors light. A value; reentrant.
class DirectionField {
 public:
  /// Over all directions of the maps, from `step_rad` on (wider where there would be too many places), with a margin.
  /// kInvalidArgument  maps without directions, or all round the sweet spot in every way.
  static Result<DirectionField> over(const std::vector<PhotometricProjector>& projectors, double step_rad);

  /// `value` of each place's direction; infinite: no bound there.
  void fill(const std::function<double(const Eigen::Vector3d&)>& value);
  /// The largest field at or below this whose logarithm changes by at most `slope_per_rad`; rounded off over
  /// `blur_rad`, which costs at most slope * blur. What has no bound gets one from its neighbours. Precondition: some
  /// place has a bound, and all are above 0.
  [[nodiscard]] DirectionField slow_below(double slope_per_rad, double blur_rad) const;
  /// With a slope for each place, in the order of places(); between two places their mean counts.
  [[nodiscard]] DirectionField slow_below(const std::vector<double>& slopes_per_rad, double blur_rad) const;
  /// The places within about `radius_rad` of where `label` changes from one number to another, neither of them 0.
  [[nodiscard]] std::vector<bool> near_borders(const std::function<unsigned(const Eigen::Vector3d&)>& label,
                                               double radius_rad) const;

  /// Between places bilinear, by the logarithm.
  [[nodiscard]] double at(const Eigen::Vector3d& direction) const;
  /// Steradians of each place; and its value.
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
