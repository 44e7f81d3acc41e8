// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>

namespace cyclorama::render {

/// A triangle projected to the unit sphere around the origin, if it is large enough to be sampled by solid angle. Uses
/// double, because the solid angle is a difference of larger angles.
class SphericalTriangle {
 public:
  /// Projects a triangle. Returns null if it is so small or thin that area sampling is as good, or so large that the
  /// origin nearly lies on it.
  [[nodiscard]] static std::optional<SphericalTriangle> see(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                                            const Eigen::Vector3d& c);
  [[nodiscard]] double solid_angle() const { return solid_angle_; }
  /// Samples a direction, uniform in solid angle. Source: Arvo, "Stratified Sampling of Spherical Triangles", 1995.
  [[nodiscard]] Eigen::Vector3d sample(double u, double v) const;

 private:
  Eigen::Vector3d a_, b_, c_;  ///< Unit vectors to the corners.
  double cos_alpha_ = 1.0;     ///< Cosine of the angle at a.
  double sin_alpha_ = 0.0;
  double solid_angle_ = 0.0;
};

}  // namespace cyclorama::render
