// SPDX-License-Identifier: Apache-2.0
/// Measures how the view moved, from the views alone: for replays, and for tests of the comfort limits.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "kiosk/tour/navigation/walk.h"

namespace cyclorama::tour {

/// Maxima in the visitor's metres and axes, of forward or sideways motion, whichever is larger. In these axes, walking
/// in a curve is not an acceleration.
struct ViewPeaks {
  double speed_m_per_s = 0.0;
  double acceleration_m_per_s2 = 0.0;
  double jerk_m_per_s3 = 0.0;
  double turn_rad_per_s = 0.0;
  double turn_acceleration_rad_per_s2 = 0.0;
  double turn_jerk_rad_per_s3 = 0.0;
  double distance_m = 0.0;
  bool finite = true;
};

/// Computes the first to third differences of positions over time. The second and third require views at even steps;
/// where a step's length changes, these two start again. A value.
class ViewMeter {
 public:
  explicit ViewMeter(double walking_scale) : scale_(walking_scale) {}
  /// Adds a view. A view at the same or an earlier time counts as a step of length zero and must not have moved.
  void add(const Eigen::Vector2d& position_m, double heading_rad, TimePoint at);
  /// Starts a new measurement: the next view may be elsewhere, although nobody walked there.
  void restart(double walking_scale) {
    scale_ = walking_scale;
    last_.reset();
    velocity_.reset();
    acceleration_.reset();
  }
  [[nodiscard]] const ViewPeaks& peaks() const { return peaks_; }

 private:
  struct View {
    Eigen::Vector2d position_m;
    double heading_rad;
    TimePoint at;
  };
  struct Motion {  ///< Components: right, forward, turn.
    Eigen::Vector3d value;
    Duration step;
  };
  double scale_;
  std::optional<View> last_;
  std::optional<Motion> velocity_;
  std::optional<Motion> acceleration_;
  ViewPeaks peaks_;
};

}  // namespace cyclorama::tour
