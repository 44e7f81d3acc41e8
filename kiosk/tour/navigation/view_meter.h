// SPDX-License-Identifier: Apache-2.0
/// How the view moved, measured on nothing but the views: for replays, and for tests of the comfort limits.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "kiosk/tour/navigation/walk.h"

namespace cyclorama {

/// In the visitor's metres and the visitor's own axes, along the worse of forward and sideways: walking in a curve is
/// no acceleration.
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

/// Differences of places over time, first to third. Views must come in even steps for the second and third to mean
/// much; where a step's length changes, those differences start anew. A value.
class ViewMeter {
 public:
  explicit ViewMeter(double walking_scale) : scale_(walking_scale) {}
  /// Views of the same or an earlier time count as a step of no length: they must not have moved.
  void add(const Eigen::Vector2d& place_m, double heading_rad, TimePoint at);
  /// The next view is somewhere else, and nobody walked there.
  void restart(double walking_scale) {
    scale_ = walking_scale;
    last_.reset();
    velocity_.reset();
    acceleration_.reset();
  }
  [[nodiscard]] const ViewPeaks& peaks() const { return peaks_; }

 private:
  struct View {
    Eigen::Vector2d place_m;
    double heading_rad;
    TimePoint at;
  };
  struct Motion {  ///< Right, forward, turn.
    Eigen::Vector3d value;
    Duration step;
  };
  double scale_;
  std::optional<View> last_;
  std::optional<Motion> velocity_;
  std::optional<Motion> acceleration_;
  ViewPeaks peaks_;
};

}  // namespace cyclorama
