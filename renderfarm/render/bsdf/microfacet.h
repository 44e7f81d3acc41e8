// SPDX-License-Identifier: Apache-2.0
/// The GGX distribution of microfacets, in a local frame whose third axis is the normal. Reentrant.
///
/// Sources: Walter et al., "Microfacet Models for Refraction through Rough Surfaces", 2007; Heitz, "Understanding the
/// Masking-Shadowing Function", JCGT 3(2), 2014; Dupuy and Benyoub, "Sampling Visible GGX Normals with Spherical Caps",
/// 2023; Eto and Tokuyoshi, "Bounded VNDF Sampling for Smith-GGX Reflections", 2023.
#pragma once

#include "renderfarm/render/vectors.h"

namespace cyclorama::render {

/// An orthonormal frame around a unit normal.
class Frame {
 public:
  explicit Frame(const Vec3& n) : s_(from_frame_of(n, Vec3::UnitX())), t_(from_frame_of(n, Vec3::UnitY())), n_(n) {}
  [[nodiscard]] Vec3 to_local(const Vec3& v) const { return {s_.dot(v), t_.dot(v), n_.dot(v)}; }
  [[nodiscard]] Vec3 from_local(const Vec3& v) const { return v.x() * s_ + v.y() * t_ + v.z() * n_; }

 private:
  Vec3 s_;
  Vec3 t_;
  Vec3 n_;
};

/// A lobe above the surface for light that bounced several times between facets of width `alpha`. A single bounce loses
/// about alpha² / (cos² + alpha²), and the pdf is proportional to this loss times the cosine.
class GrazingLobe {
 public:
  explicit GrazingLobe(float alpha)
      : start2_(std::max(alpha * alpha, kMinStart2)), range_(std::log((1.0f + start2_) / start2_)) {}
  [[nodiscard]] float pdf(float cosine) const { return cosine / (kPi * range_ * (cosine * cosine + start2_)); }
  [[nodiscard]] Vec3 sample(const Vec2& u) const {
    const float cosine2 = std::clamp(start2_ * std::expm1(u.x() * range_), 0.0f, 1.0f);
    const float sine = std::sqrt(1.0f - cosine2);
    const float angle = 2.0f * kPi * u.y();
    return {sine * std::cos(angle), sine * std::sin(angle), std::sqrt(cosine2)};
  }

 private:
  static constexpr float kMinStart2 = 1e-8f;
  float start2_;
  float range_;
};

/// Returns `wo` raised above the shading normal's horizon: near silhouettes the normal may point away from the viewer,
/// but the lobes require a visible one.
[[nodiscard]] inline Vec3 seen_from_above(const Vec3& wo) {
  constexpr float kMinCosine = 1e-3f;
  if (wo.z() >= kMinCosine) return wo;
  return normalized_or({wo.x(), wo.y(), kMinCosine}, Vec3::UnitZ());
}

/// The GGX distribution of width `alpha` > 0, seen from `wo` with wo.z > 0.
class Microfacets {
 public:
  Microfacets(float alpha, const Vec3& wo) : alpha2_(alpha * alpha), alpha_(alpha), wo_(wo), root_(root(wo.z())) {}

  /// Returns the distribution of normals (GGX's D) at h, with h.z > 0. Uses sine and cosine, because 1 - cos² loses its
  /// precision in a narrow lobe.
  [[nodiscard]] float pdf(const Vec3& h) const {
    const float d = h.x() * h.x() + h.y() * h.y() + alpha2_ * h.z() * h.z();
    return d > 0.0f ? alpha2_ / (kPi * d * d) : 0.0f;
  }
  /// Returns the masking-shadowing function divided by 4 times both cosines (Heitz 2014, equation 99). Precondition:
  /// both cosines are positive.
  [[nodiscard]] float visibility(float cos_i) const { return 0.5f / (cos_i * root_ + wo_.z() * root(cos_i)); }

  /// Samples a normal visible from wo. With `bounded`, nearly all samples mirror wo to a direction above the surface.
  [[nodiscard]] Vec3 sample(const Vec2& u, bool bounded) const {
    const Vec3 stretched = Vec3(alpha_ * wo_.x(), alpha_ * wo_.y(), wo_.z()) / root_;
    const float b = (bounded ? bound() : 1.0f) * stretched.z();
    const float z = (1.0f - u.x()) * (1.0f + b) - b;
    const float radius = std::sqrt(std::max(0.0f, 1.0f - z * z));
    const float angle = 2.0f * kPi * u.y();
    const Vec3 h = stretched + Vec3(radius * std::cos(angle), radius * std::sin(angle), z);
    return normalized_or({alpha_ * h.x(), alpha_ * h.y(), h.z()}, Vec3::UnitZ());
  }
  /// Returns the pdf of the directions to which the sampled normals mirror wo; `d` is pdf(h).
  [[nodiscard]] float reflected_pdf(float d, bool bounded) const {
    return 0.5f * d / ((bounded ? bound() : 1.0f) * wo_.z() + root_);
  }
  /// Returns the pdf of the sampled normals themselves, unbounded; `d` is pdf(h), o_h the cosine between wo and h.
  [[nodiscard]] float microfacet_pdf(float d, float o_h) const { return 2.0f * d * o_h / (wo_.z() + root_); }

 private:
  [[nodiscard]] float root(float cosine) const { return std::sqrt(alpha2_ + (1.0f - alpha2_) * cosine * cosine); }
  /// Returns Eto and Tokuyoshi's k.
  [[nodiscard]] float bound() const {
    const float s = 1.0f + std::sqrt(std::max(0.0f, 1.0f - wo_.z() * wo_.z()));
    const float s2 = s * s;
    return (1.0f - alpha2_) * s2 / (s2 + alpha2_ * wo_.z() * wo_.z());
  }

  float alpha2_;
  float alpha_;
  Vec3 wo_;
  float root_;
};

}  // namespace cyclorama::render
