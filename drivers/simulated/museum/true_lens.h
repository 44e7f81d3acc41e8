// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "common/room/pinhole.h"

namespace cyclorama::simulated {

/// A wave of small displacements over a lens's picture, in pixels.
struct LensWave {
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();
  Eigen::Vector2d rad_per_px = Eigen::Vector2d::Zero();
  double phase_rad = 0.0;
};

/// A lens with the distortion of Brown ("Decentering Distortion of Lenses", 1966), in OpenCV's order and signs, so that
/// a calibration's parameters can be compared one by one:
///
///   seen = ideal * (1 + k1 r^2 + k2 r^4 + k3 r^6) + (2 p1 x y + p2 (r^2 + 2 x^2),  p1 (r^2 + 2 y^2) + 2 p2 x y)
///
/// where ideal = (x, y) = (X / Z, Y / Z), r is its length, and pixel = centre + focal * seen. Lenses as they are sold
/// leave a residue that no such lens has: waves of displacements, added to `seen`. Beyond the radius at
/// which the radial part turns back, two rays would share a pixel; the lens sees nothing there. A value; reentrant.
class TrueLens {
 public:
  TrueLens() = default;
  explicit TrueLens(const Pinhole& pinhole, const std::array<double, 3>& radial = {},
                    const std::array<double, 2>& tangential = {}, std::vector<LensWave> waves = {});

  [[nodiscard]] const Pinhole& pinhole() const { return pinhole_; }
  [[nodiscard]] const std::array<double, 3>& radial() const { return radial_; }
  [[nodiscard]] const std::array<double, 2>& tangential() const { return tangential_; }
  [[nodiscard]] const std::vector<LensWave>& waves() const { return waves_; }
  /// Maximum length of the ideal point; rays farther from the axis are not seen.
  [[nodiscard]] double max_tangent() const { return max_tangent_; }

  [[nodiscard]] Eigen::Vector2d distorted(const Eigen::Vector2d& ideal) const;
  /// Derivative of distorted() with respect to `ideal`.
  [[nodiscard]] Eigen::Matrix2d derivative(const Eigen::Vector2d& ideal) const;
  /// Inverts distorted() by Newton's method to within 1e-12; returns nothing if no ray of the lens arrives at `seen`.
  [[nodiscard]] std::optional<Eigen::Vector2d> undistorted(const Eigen::Vector2d& seen) const;

  /// Projects a point in front of the lens; the pixel may lie outside the picture.
  [[nodiscard]] std::optional<Eigen::Vector2d> pixel_of(const Eigen::Vector3d& point) const;
  /// Returns a direction with z = 1, not normalised; nothing if the lens has no ray for the pixel.
  [[nodiscard]] std::optional<Eigen::Vector3d> direction_at(double u, double v) const;

 private:
  [[nodiscard]] Eigen::Vector2d brown(const Eigen::Vector2d& ideal) const;
  [[nodiscard]] Eigen::Matrix2d brown_derivative(const Eigen::Vector2d& ideal) const;

  Pinhole pinhole_;
  std::array<double, 3> radial_{};
  std::array<double, 2> tangential_{};
  std::vector<LensWave> waves_{};
  double max_tangent_ = 1e3;
};

}  // namespace cyclorama::simulated
