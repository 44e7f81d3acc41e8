// SPDX-License-Identifier: Apache-2.0
/// The One-Euro filter: a low-pass whose cut-off rises with speed, so that a hand at rest is calm and a moving hand is
/// not delayed. Source: Casiez, Roussel and Vogel, "1 € Filter", CHI 2012, algorithm 1, which measures the speed from
/// the last result to the measurement. For a rotation, the speed is the length of its angular velocity, and the result
/// follows the shortest arc.
///
/// Pure functions of (settings, state, measurement, time). The result is finite for any time stamps:
///   repeated, or earlier by less than kRestartAfter   the measurement is ignored and the last result returned
///   later or earlier by kRestartAfter or more         the filter starts again at the measurement
///   a measurement that is not finite                  is ignored; if there is no last result, the result is empty
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "common/base/clock.h"

namespace cyclorama::tracker {

struct OneEuroSettings {
  double min_cutoff_hz = 1.0;     ///< Cut-off at rest: a lower one gives less jitter and more delay. More than 0.
  double cutoff_per_speed = 0.0;  ///< Beta: Hz per unit of speed (metre or radian per second). 0 or more.
  double speed_cutoff_hz = 1.0;   ///< Cut-off for the speed itself; 1 Hz as in the paper. More than 0.
};

inline constexpr Duration kRestartAfter = std::chrono::milliseconds(500);

struct FilteredPosition {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();  ///< In metres.
  Eigen::Vector3d speed = Eigen::Vector3d::Zero();  ///< In metres per second.
  TimePoint at{};
};
struct FilteredRotation {
  Eigen::Quaterniond value = Eigen::Quaterniond::Identity();
  /// Angular velocity in the rotation's From frame, radians per second.
  Eigen::Vector3d speed = Eigen::Vector3d::Zero();
  TimePoint at{};
};

[[nodiscard]] std::optional<FilteredPosition> filter(const OneEuroSettings& settings,
                                                     const std::optional<FilteredPosition>& last,
                                                     const Eigen::Vector3d& measured, TimePoint at);
[[nodiscard]] std::optional<FilteredRotation> filter(const OneEuroSettings& settings,
                                                     const std::optional<FilteredRotation>& last,
                                                     const Eigen::Quaterniond& measured, TimePoint at);

}  // namespace cyclorama::tracker
