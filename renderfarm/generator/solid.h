// SPDX-License-Identifier: Apache-2.0
/// Signed distances of rounded solids, and their blends, from which figures are made. Negative inside, metres. Source
/// of the formulas: I. Quilez, "Distance functions" and "Smooth minimum", iquilezles.org/articles, 2023.
#pragma once

#include "renderfarm/generator/vec.h"

namespace cyclorama::generator {

[[nodiscard]] inline float sphere(const Vec3& p, const Vec3& centre, float radius) {
  return (p - centre).norm() - radius;
}

/// Exact on the surface and close enough elsewhere for stepping to the surface.
[[nodiscard]] inline float ellipsoid(const Vec3& p, const Vec3& centre, const Vec3& radii) {
  const Vec3 q = (p - centre).cwiseQuotient(radii);
  const float k0 = q.norm();
  const float k1 = q.cwiseQuotient(radii).norm();
  return k1 > 1e-6f ? k0 * (k0 - 1.0f) / k1 : -radii.minCoeff();
}

/// A limb from `a` with radius `ra` to `b` with radius `rb`.
[[nodiscard]] inline float limb(const Vec3& p, const Vec3& a, float ra, const Vec3& b, float rb) {
  const Vec3 ab = b - a;
  const float t = unit_clamp((p - a).dot(ab) / ab.squaredNorm());
  return (p - a - t * ab).norm() - mix(ra, rb, t);
}

/// A box with edges rounded by `round`; `half` is the distance from its centre to its faces.
[[nodiscard]] inline float rounded_box(const Vec3& p, const Vec3& centre, const Vec3& half, float round) {
  const Vec3 q = (p - centre).cwiseAbs() - (half - Vec3::Constant(round));
  return q.cwiseMax(0.0f).norm() + std::min(q.maxCoeff(), 0.0f) - round;
}

/// Union of two solids, with a fillet about `k` wide.
[[nodiscard]] inline float blend(float a, float b, float k) {
  const float h = std::max(k - std::abs(a - b), 0.0f) / k;
  return std::min(a, b) - h * h * k * 0.25f;
}

/// `a` without `b`, with a rounded edge about `k` wide.
[[nodiscard]] inline float carve(float a, float b, float k) { return -blend(-a, b, k); }

/// Height of a fold, in [0, 1]; `phase` counts the folds. Round ridges, sharp valleys.
[[nodiscard]] inline float fold_profile(float phase) {
  return std::pow(0.5f + 0.5f * std::cos(2.0f * kPi * phase), 0.65f);
}

/// Visibility of a pattern of the given period on a grid, in [0, 1]; 0 below about three vertices per period.
[[nodiscard]] inline float shown(float period, float spacing) { return smooth_step(0.42f, 0.25f, spacing / period); }

}  // namespace cyclorama::generator
