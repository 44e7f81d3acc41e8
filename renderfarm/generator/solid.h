// SPDX-License-Identifier: Apache-2.0
/// Signed distances of rounded solids, and their blends, from which figures are made. Distances are in metres, negative
/// inside. Source of the formulas: I. Quilez, "Distance functions" and "Smooth minimum", iquilezles.org/articles, 2023.
#pragma once

#include "renderfarm/generator/vec.h"

namespace cyclorama::generator {

[[nodiscard]] inline float sphere(const Vec3& p, const Vec3& centre, float radius) {
  return (p - centre).norm() - radius;
}

/// Returns a distance that is exact on the surface, and close enough elsewhere for stepping to the surface.
[[nodiscard]] inline float ellipsoid(const Vec3& p, const Vec3& centre, const Vec3& radii) {
  const Vec3 q = (p - centre).cwiseQuotient(radii);
  const float k0 = q.norm();
  const float k1 = q.cwiseQuotient(radii).norm();
  return k1 > 1e-6f ? k0 * (k0 - 1.0f) / k1 : -radii.minCoeff();
}

/// Returns the distance to a limb from `a`, with radius `ra`, to `b`, with radius `rb`.
[[nodiscard]] inline float limb(const Vec3& p, const Vec3& a, float ra, const Vec3& b, float rb) {
  const Vec3 ab = b - a;
  const float t = unit_clamp((p - a).dot(ab) / ab.squaredNorm());
  return (p - a - t * ab).norm() - mix(ra, rb, t);
}

/// Returns the distance to a box with edges rounded by `round`; `half` is the distance from its centre to its faces.
[[nodiscard]] inline float rounded_box(const Vec3& p, const Vec3& centre, const Vec3& half, float round) {
  const Vec3 q = (p - centre).cwiseAbs() - (half - Vec3::Constant(round));
  return q.cwiseMax(0.0f).norm() + std::min(q.maxCoeff(), 0.0f) - round;
}

/// Returns the distance to the union of two solids, with a fillet about `k` wide.
[[nodiscard]] inline float blend(float a, float b, float k) {
  const float h = std::max(k - std::abs(a - b), 0.0f) / k;
  return std::min(a, b) - h * h * k * 0.25f;
}

/// Returns the distance to `a` without `b`, with a rounded edge about `k` wide.
[[nodiscard]] inline float carve(float a, float b, float k) { return -blend(-a, b, k); }

/// Returns the height of a fold with round ridges and sharp valleys, in [0, 1]; `phase` counts the folds.
[[nodiscard]] inline float fold_profile(float phase) {
  return std::pow(0.5f + 0.5f * std::cos(2.0f * kPi * phase), 0.65f);
}

/// Returns the visibility of a pattern of the given period on a grid: 0 below 2.4 vertices per period, 1 above 4.
[[nodiscard]] inline float shown(float period, float spacing) { return smooth_step(0.42f, 0.25f, spacing / period); }

}  // namespace cyclorama::generator
