// SPDX-License-Identifier: Apache-2.0
/// How a surface scatters light: Lambert, and under it or instead of it a GGX lobe, as glTF 2.0 (appendix B) has them.
/// Sources: Walter et al., "Microfacet Models for Refraction through Rough Surfaces", 2007; Heitz, "Sampling the GGX
/// Distribution of Visible Normals", JCGT 7(4), 2018.
#pragma once

#include "renderfarm/render/vectors.h"

namespace cyclorama {

/// Below this roughness a highlight of a small lamp becomes a handful of blinding pixels.
inline constexpr float kLeastRoughness = 0.06f;

/// One surface point's reflection. Colours are linear; all of them finite and not negative.
struct Bsdf {
  Vec3 diffuse = Vec3::Zero();  ///< Albedo of the Lambertian part.
  Vec3 f0 = Vec3::Zero();       ///< Reflectance along the normal; zero for matte surfaces, which have no lobe.
  float alpha = 1.0f;           ///< GGX's width: roughness squared.
};

[[nodiscard]] inline Bsdf make_matte(const Vec3& albedo) { return {albedo, Vec3::Zero(), 1.0f}; }

[[nodiscard]] inline Bsdf make_glossy(const Vec3& base_colour, float metallic, float roughness) {
  constexpr float kDielectricF0 = 0.04f;
  const float rough = std::clamp(roughness, kLeastRoughness, 1.0f);
  return {base_colour * (1.0f - metallic), Vec3::Constant(kDielectricF0 * (1.0f - metallic)) + base_colour * metallic,
          rough * rough};
}

/// Fresnel's reflectance, Schlick's fit.
[[nodiscard]] inline Vec3 fresnel(const Vec3& f0, float cosine) {
  const float m = std::clamp(1.0f - cosine, 0.0f, 1.0f);
  const float m2 = m * m;
  return f0 + (Vec3::Ones() - f0) * (m2 * m2 * m);
}

[[nodiscard]] inline float ggx_density(float alpha2, float n_h) {
  const float d = n_h * n_h * (alpha2 - 1.0f) + 1.0f;
  return alpha2 / (kPi * d * d);
}
[[nodiscard]] inline float ggx_lambda_root(float alpha2, float n_w) {
  return std::sqrt(alpha2 + (1.0f - alpha2) * n_w * n_w);
}

/// `normal` bent just so far that what a mirror shows lies above the surface itself, whose side is `facing`: on coarse
/// meshes a smooth normal otherwise reflects the inside, as black rings. All unit vectors; wo and normal are on
/// facing's side. Source: Keller et al., "The Iray Light Transport Simulation and Rendering System", 2017.
[[nodiscard]] inline Vec3 reflecting_normal(const Vec3& normal, const Vec3& facing, const Vec3& wo) {
  const Vec3 mirrored = 2.0f * normal.dot(wo) * normal - wo;
  const float wanted = std::min(0.05f, facing.dot(wo));
  const float above = facing.dot(mirrored);
  if (above >= wanted) return normal;
  const Vec3 lifted = normalized_or(mirrored + facing * (wanted - above), facing);
  return normalized_or(wo + lifted, facing);
}

/// A surface seen from `wo`; all directions are unit vectors that point away from it. Precondition of every query: both
/// directions are above the surface; below, the answer is zero.
template <bool kGloss>
class Scattering {
 public:
  Scattering(const Bsdf& bsdf, const Vec3& normal, const Vec3& wo)
      // A shading normal may turn away from the viewer near silhouettes; the lobe wants to be seen.
      : bsdf_(bsdf), n_(normal), wo_(wo), n_wo_(std::clamp(normal.dot(wo), 1e-3f, 1.0f)) {
    if constexpr (kGloss) has_lobe_ = bsdf.f0.maxCoeff() > 0.0f;
  }

  /// BSDF times the cosine of `wi`.
  [[nodiscard]] Vec3 evaluate(const Vec3& wi) const {
    const float n_wi = n_.dot(wi);
    if (!(n_wi > 0.0f)) return Vec3::Zero();
    if constexpr (kGloss) {
      if (has_lobe_) return evaluate_glossy(wi, n_wi);
    }
    return bsdf_.diffuse * (n_wi / kPi);
  }

  /// A direction for light from all around, chosen by `u` and `choice` in [0, 1); ret_weight is evaluate / density.
  /// May lie below the surface, with weight zero.
  [[nodiscard]] Vec3 sample(const Vec2& u, float choice, Vec3* ret_weight) const {
    if constexpr (kGloss) {
      if (has_lobe_) return sample_glossy(u, choice, ret_weight);
    }
    *ret_weight = bsdf_.diffuse;
    return from_frame_of(n_, cosine_hemisphere(u));
  }

  /// What comes back of light that is the same from everywhere; the lobe by Karis's fit of its integral
  /// ("Physically Based Shading on Mobile", 2014).
  [[nodiscard]] Vec3 albedo() const {
    if constexpr (kGloss) {
      if (has_lobe_) {
        const float rough = std::sqrt(bsdf_.alpha);
        const float r0 = 1.0f - rough;
        const float a004 = std::min(r0 * r0, std::exp2(-9.28f * n_wo_)) * r0 + (-0.0275f * rough + 0.0425f);
        const Vec3 lobe = bsdf_.f0 * (-1.04f * a004 + (-0.572f * rough + 1.04f)) +
                          Vec3::Constant(1.04f * a004 + (0.022f * rough - 0.04f));
        return (bsdf_.diffuse + lobe).cwiseMin(Vec3::Ones().cwiseMax(bsdf_.diffuse)).cwiseMax(0.0f);
      }
    }
    return bsdf_.diffuse;
  }

 private:
  [[nodiscard]] Vec3 evaluate_glossy(const Vec3& wi, float n_wi) const {
    const Vec3 h = normalized_or(wo_ + wi, n_);
    const float alpha2 = bsdf_.alpha * bsdf_.alpha;
    const float d = ggx_density(alpha2, std::clamp(n_.dot(h), 0.0f, 1.0f));
    const float visibility = 0.5f / (n_wi * ggx_lambda_root(alpha2, n_wo_) + n_wo_ * ggx_lambda_root(alpha2, n_wi));
    const Vec3 f = fresnel(bsdf_.f0, std::max(0.0f, h.dot(wi)));
    return ((Vec3::Ones() - f).cwiseProduct(bsdf_.diffuse) / kPi + f * (d * visibility)) * n_wi;
  }

  [[nodiscard]] float lobe_probability() const {
    const float lobe = luminance(fresnel(bsdf_.f0, n_wo_));
    return lobe / (lobe + luminance(bsdf_.diffuse) + 1e-6f);
  }

  /// Density of sample(): both ways of making a direction together.
  [[nodiscard]] float density(const Vec3& wi, float p_lobe) const {
    const float n_wi = n_.dot(wi);
    const Vec3 h = normalized_or(wo_ + wi, n_);
    const float alpha2 = bsdf_.alpha * bsdf_.alpha;
    const float d = ggx_density(alpha2, std::clamp(n_.dot(h), 0.0f, 1.0f));
    const float visible_normals = 0.5f * d / (n_wo_ + ggx_lambda_root(alpha2, n_wo_));
    return p_lobe * visible_normals + (1.0f - p_lobe) * std::max(0.0f, n_wi) / kPi;
  }

  [[nodiscard]] Vec3 sample_glossy(const Vec2& u, float choice, Vec3* ret_weight) const {
    const float p_lobe = lobe_probability();
    Vec3 wi;
    if (choice < p_lobe) {
      const Vec3 h = sample_visible_normal(u);
      wi = normalized_or(2.0f * wo_.dot(h) * h - wo_, n_);
    } else {
      wi = from_frame_of(n_, cosine_hemisphere(u));
    }
    const float p = density(wi, p_lobe);
    *ret_weight = p > 0.0f ? Vec3(evaluate(wi) / p) : Vec3(Vec3::Zero());
    return wi;
  }

  /// Heitz 2018, listing 1, in a frame about n whose first axis carries the viewer.
  [[nodiscard]] Vec3 sample_visible_normal(const Vec2& u) const {
    const Vec3 side = normalized_or(wo_ - n_ * n_.dot(wo_), from_frame_of(n_, Vec3::UnitX()));
    const Vec3 other = n_.cross(side);
    const float sine = std::sqrt(std::max(0.0f, 1.0f - n_wo_ * n_wo_));
    const Vec3 v = Vec3(bsdf_.alpha * sine, 0.0f, n_wo_).normalized();
    const float r = std::sqrt(u.x());
    const float angle = 2.0f * kPi * u.y();
    const float t1 = r * std::cos(angle);
    const float s = 0.5f * (1.0f + v.z());
    const float t2 = (1.0f - s) * std::sqrt(std::max(0.0f, 1.0f - t1 * t1)) + s * r * std::sin(angle);
    const float along = std::sqrt(std::max(0.0f, 1.0f - t1 * t1 - t2 * t2));
    // v lies in the plane y = 0, so its frame is (0, 1, 0) and v x (0, 1, 0).
    const Vec3 stretched = t1 * Vec3(0.0f, 1.0f, 0.0f) + t2 * Vec3(-v.z(), 0.0f, v.x()) + along * v;
    const Vec3 h = Vec3(bsdf_.alpha * stretched.x(), bsdf_.alpha * stretched.y(), std::max(1e-6f, stretched.z()));
    return normalized_or(h.x() * side + h.y() * other + h.z() * n_, n_);
  }

  const Bsdf& bsdf_;
  Vec3 n_;
  Vec3 wo_;
  float n_wo_;
  bool has_lobe_ = false;
};

}  // namespace cyclorama
