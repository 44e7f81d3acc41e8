// SPDX-License-Identifier: Apache-2.0
/// Small vector helpers of the ray kernels. Vectors are float, in the render frame: the Scene frame moved close to the
/// eye.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace cyclorama::render {

using Vec2 = Eigen::Vector2f;
using Vec3 = Eigen::Vector3f;

inline constexpr float kPi = 3.14159265358979323846f;

[[nodiscard]] inline Vec3 to_vec3(const std::array<float, 3>& a) { return {a[0], a[1], a[2]}; }
[[nodiscard]] inline Vec2 to_vec2(const std::array<float, 2>& a) { return {a[0], a[1]}; }

/// Returns the luminance of a linear colour; Rec. 709 weights.
[[nodiscard]] inline float luminance(const Vec3& c) { return 0.2126f * c.x() + 0.7152f * c.y() + 0.0722f * c.z(); }

[[nodiscard]] inline bool is_finite(const Vec3& v) {
  return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z());
}

/// Returns `v` at unit length, or `fallback` if it has no direction (zero, NaN, infinite). Also works for vectors whose
/// squared length leaves the range of float.
[[nodiscard]] inline Vec3 normalized_or(const Vec3& v, const Vec3& fallback) {
  const float length2 = v.squaredNorm();
  if (length2 > 1e-30f && length2 < 1e30f) return v * (1.0f / std::sqrt(length2));
  const float largest = v.cwiseAbs().maxCoeff();
  if (!(largest > 0.0f) || !std::isfinite(largest) || !is_finite(v)) return fallback;
  return (v / largest).normalized();
}

/// Returns the matrix that transforms normals when `linear` transforms points: the inverse transpose up to a positive
/// factor, which exists even for singular matrices. Normals that point outwards still do so under mirroring.
[[nodiscard]] inline Eigen::Matrix3f normal_matrix_of(const Eigen::Matrix3d& linear) {
  Eigen::Matrix3d cofactors;
  cofactors.col(0) = linear.col(1).cross(linear.col(2));
  cofactors.col(1) = linear.col(2).cross(linear.col(0));
  cofactors.col(2) = linear.col(0).cross(linear.col(1));
  const double largest = cofactors.cwiseAbs().maxCoeff();
  if (!(largest > 0.0)) return Eigen::Matrix3f::Identity();
  return (cofactors / (linear.determinant() < 0.0 ? -largest : largest)).cast<float>();
}

/// Transforms `local` from the frame whose third axis is the unit vector `n`.
/// Source: Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
[[nodiscard]] inline Vec3 from_frame_of(const Vec3& n, const Vec3& local) {
  const float sign = std::copysign(1.0f, n.z());
  const float a = -1.0f / (sign + n.z());
  const float b = n.x() * n.y() * a;
  const Vec3 s(1.0f + sign * n.x() * n.x() * a, sign * b, -sign * n.x());
  const Vec3 t(b, sign + n.y() * n.y() * a, -n.y());
  return local.x() * s + local.y() * t + local.z() * n;
}

/// Maps the unit square to the hemisphere about +z, with pdf cos / pi.
[[nodiscard]] inline Vec3 cosine_hemisphere(const Vec2& u) {
  const float radius = std::sqrt(u.x());
  const float angle = 2.0f * kPi * u.y();
  return {radius * std::cos(angle), radius * std::sin(angle), std::sqrt(std::max(0.0f, 1.0f - u.x()))};
}

/// Maps the unit square to the cap about +z with 1 - cos(half angle) = `one_minus_cos`, uniformly in solid angle.
[[nodiscard]] inline Vec3 uniform_cap(const Vec2& u, float one_minus_cos) {
  const float height = u.x() * one_minus_cos;  // 1 - cos, which stays precise for tiny caps.
  const float radius = std::sqrt(std::max(0.0f, height * (2.0f - height)));
  const float angle = 2.0f * kPi * u.y();
  return {radius * std::cos(angle), radius * std::sin(angle), 1.0f - height};
}

}  // namespace cyclorama::render
