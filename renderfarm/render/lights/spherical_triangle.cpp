// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/lights/spherical_triangle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cyclorama::render {
namespace {

/// Solid angle below which area sampling has nearly the pdf of solid-angle sampling.
constexpr double kMinSolidAngle = 1e-3;
constexpr double kMaxSolidAngle = 6.2;  // Close to the 2 pi of a hemisphere.
/// Lower bound for the sine of the angle at corner a: the rotation about it is imprecise for thinner triangles.
constexpr double kThinnestSine = 1e-5;

/// Returns the unit vector of `v`'s component perpendicular to the unit vector `n`; zero if there is none.
Eigen::Vector3d aside(const Eigen::Vector3d& v, const Eigen::Vector3d& n) {
  const Eigen::Vector3d rest = v - n * n.dot(v);
  const double length = rest.norm();
  return length > 0.0 ? Eigen::Vector3d(rest / length) : Eigen::Vector3d(Eigen::Vector3d::Zero());
}

}  // namespace

std::optional<SphericalTriangle> SphericalTriangle::see(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                                        const Eigen::Vector3d& c) {
  // Van Oosterom and Strackee, "The Solid Angle of a Plane Triangle", 1983. The determinant is computed from the edges,
  // because the corners may nearly coincide.
  const double la = a.norm();
  const double lb = b.norm();
  const double lc = c.norm();
  const double determinant = std::abs(a.dot((b - a).cross(c - a)));
  const double rest = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  SphericalTriangle seen;
  seen.solid_angle_ = 2.0 * std::atan2(determinant, rest);
  if (!(seen.solid_angle_ >= kMinSolidAngle && seen.solid_angle_ <= kMaxSolidAngle)) return std::nullopt;
  seen.a_ = a / la;
  seen.b_ = b / lb;
  seen.c_ = c / lc;
  const Eigen::Vector3d to_b = aside(seen.b_, seen.a_);
  const Eigen::Vector3d to_c = aside(seen.c_, seen.a_);
  seen.cos_alpha_ = std::clamp(to_b.dot(to_c), -1.0, 1.0);
  seen.sin_alpha_ = to_b.cross(to_c).norm();
  if (!(seen.sin_alpha_ > kThinnestSine)) return std::nullopt;
  return seen;
}

Eigen::Vector3d SphericalTriangle::sample(double u, double v) const {
  // Corner c is moved so that the share u of the area lies before it; then a point is sampled on the arc from b to the
  // moved corner.
  const double part = u * solid_angle_;  // s and t are the sine and cosine of part + pi - alpha.
  const double s = cos_alpha_ * -std::sin(part) + sin_alpha_ * std::cos(part);
  const double t = -cos_alpha_ * std::cos(part) - sin_alpha_ * std::sin(part);
  const double k1 = t + cos_alpha_;
  const double k2 = s - sin_alpha_ * a_.dot(b_);
  const double below = (k2 * s + k1 * t) * sin_alpha_;
  const double cos_b = below != 0.0 ? std::clamp((k2 + (k2 * t - k1 * s) * cos_alpha_) / below, -1.0, 1.0) : 1.0;
  const double sin_b = std::sqrt(1.0 - cos_b * cos_b);
  const Eigen::Vector3d moved = cos_b * a_ + sin_b * aside(c_, a_);
  const double one_minus_z = v * (1.0 - moved.dot(b_));
  const double radius = std::sqrt(std::max(0.0, one_minus_z * (2.0 - one_minus_z)));
  return (1.0 - one_minus_z) * b_ + radius * aside(moved, b_);
}

}  // namespace cyclorama::render
