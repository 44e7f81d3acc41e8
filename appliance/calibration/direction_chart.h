// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <optional>
#include <span>

namespace cyclorama::calibration {

/// Directions as positions in a plane (azimuthal equidistant projection): the angle from a middle direction, with its
/// bearing. Smooth everywhere except opposite the middle, so a map has no seam and no pole. A value; reentrant.
class DirectionChart {
 public:
  explicit DirectionChart(const Eigen::Vector3d& middle) : middle_(middle.normalized()) {
    right_ = middle_.unitOrthogonal();
    up_ = right_.cross(middle_);
  }

  /// Creates a chart about the mean of all `samples` (each has a `direction`); empty if a sample is more than 170
  /// degrees from it.
  template <typename Samples>
  static std::optional<DirectionChart> around(const Samples& samples) {
    constexpr double kMinCos = -0.985;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& sample : samples) sum += sample.direction;
    if (!(sum.norm() > 1e-6 * static_cast<double>(samples.size()))) return std::nullopt;
    DirectionChart chart(sum);
    for (const auto& sample : samples) {
      if (!(chart.middle_.dot(sample.direction) > kMinCos)) return std::nullopt;
    }
    return chart;
  }

  /// Returns the position of a direction; empty opposite the middle. Precondition: `direction` has unit length.
  [[nodiscard]] std::optional<Eigen::Vector2d> place_of(const Eigen::Vector3d& direction) const {
    const Eigen::Vector2d side(direction.dot(right_), direction.dot(up_));
    const double sine = side.norm();
    const double cosine = direction.dot(middle_);
    if (!std::isfinite(sine) || (sine < 1e-12 && cosine < 0.0)) return std::nullopt;
    if (sine < 1e-12) return side;
    return side * (std::atan2(sine, cosine) / sine);
  }
  /// Returns the unit vector of a position; empty more than half a turn from the middle.
  [[nodiscard]] std::optional<Eigen::Vector3d> direction_of(const Eigen::Vector2d& position) const {
    const double angle = position.norm();
    if (!(angle < 3.14159265)) return std::nullopt;
    const double factor = angle < 1e-9 ? 1.0 : std::sin(angle) / angle;
    return (std::cos(angle) * middle_ + factor * (position.x() * right_ + position.y() * up_)).normalized();
  }

 private:
  Eigen::Vector3d middle_;
  Eigen::Vector3d right_;
  Eigen::Vector3d up_;
};

}  // namespace cyclorama::calibration
