// SPDX-License-Identifier: Apache-2.0
/// glTF's opaque surface: a metal, or Lambertian reflection under a dielectric's gloss, or a mixture of both.
///
/// This extends appendix B of glTF 2.0, which loses light on rough surfaces. Here, light that bounces several times
/// between the facets leaves as a wide lobe (Kulla and Conty 2017). Light that passes through the gloss in both
/// directions is normalised in the same manner, so that white surfaces stay white and the BRDF is reciprocal.
#pragma once

#include "renderfarm/render/bsdf/albedo_table.h"
#include "renderfarm/render/bsdf/bsdf.h"
#include "renderfarm/render/bsdf/fresnel.h"

namespace cyclorama::render {

/// Returns the share of light that emerges after two or more bounces off facets of mean reflectance `mean`. `once` is
/// the mean share that emerges after one bounce off a perfect mirror.
[[nodiscard]] inline float after_more_bounces(float mean, float once) {
  return mean * mean * once / std::max(1e-6f, 1.0f - mean * (1.0f - once));
}
[[nodiscard]] inline Vec3 after_more_bounces(const Vec3& mean, float once) {
  return {after_more_bounces(mean.x(), once), after_more_bounces(mean.y(), once), after_more_bounces(mean.z(), once)};
}

/// Returns f(o) / mean(f), the factor of a lobe f(o) f(i) / mean(f) that depends on the viewer alone.
[[nodiscard]] inline float share(float here, float mean) { return mean > 0.0f ? here / mean : 0.0f; }

/// An opaque surface seen from one direction: the colour of its glossy lobe, and all other reflection as one wide lobe.
/// Thread-bound.
class OpaqueBase {
 public:
  /// `dielectric` and `diffuse` are the shares of the surface that have a dielectric's gloss and Lambertian reflection
  /// below it.
  OpaqueBase(const Bsdf& bsdf, float cos_o, float dielectric, float diffuse)
      : row_(bsdf.alpha),
        f0_(bsdf.f0 * dielectric + bsdf.base_colour * bsdf.metallic),
        f90_(bsdf.f90 * dielectric + bsdf.metallic),
        diffuse_(bsdf.base_colour * diffuse),
        gloss_f0_(bsdf.f0.maxCoeff()),
        gloss_f90_(bsdf.f90) {
    const BounceAlbedo mean = row_.mean();
    const float once = 1.0f - mean.lost;
    const Vec3 gloss_mean = bsdf.f0 + (Vec3::Constant(bsdf.f90) - bsdf.f0) * kMeanSchlick;
    more_ = after_more_bounces(gloss_mean, once) * dielectric;
    gloss_more_ = after_more_bounces(gloss_mean.maxCoeff(), once);
    if (bsdf.metallic > 0.0f) {
      const Vec3 metal_mean = bsdf.base_colour + (Vec3::Ones() - bsdf.base_colour) * kMeanSchlick;
      more_ += after_more_bounces(metal_mean, once) * bsdf.metallic;
    }
    const BounceAlbedo seen = row_.at(cos_o);
    gloss_albedo_ = f0_ * seen.low + Vec3::Constant(f90_ * seen.high);
    const float under = std::max(0.0f, 1.0f - reflected(seen));
    more_albedo_ = more_ * seen.lost;
    diffuse_albedo_ = diffuse_ * under;
    more_ *= share(seen.lost, mean.lost);
    diffuse_ *= share(under, 1.0f - reflected(mean));
  }

  /// Returns the reflectance of a facet; `o_h` is the cosine between the viewer's direction and the facet's normal.
  [[nodiscard]] Vec3 facet(float o_h) const {
    const float grazing = schlick(o_h);
    return f0_ * (1.0f - grazing) + Vec3::Constant(f90_ * grazing);
  }
  /// Returns the wide lobe times pi, without the cosine. The result is zero if `cos_i` is 0.
  [[nodiscard]] Vec3 wide(float cos_i) const {
    const BounceAlbedo lit = row_.at(cos_i);
    return more_ * lit.lost + diffuse_ * std::max(0.0f, 1.0f - reflected(lit));
  }
  /// Returns the albedo of one bounce off facets of this roughness.
  [[nodiscard]] BounceAlbedo bounce(float cosine) const { return row_.at(cosine); }
  [[nodiscard]] BounceAlbedo mean_bounce() const { return row_.mean(); }
  /// Returns the share of BounceAlbedo::lost that the dielectric's gloss reflects in further bounces.
  [[nodiscard]] float gloss_more() const { return gloss_more_; }
  /// Returns the dielectric's reflectance for a single bounce.
  [[nodiscard]] float gloss_once(const BounceAlbedo& a) const { return gloss_f0_ * a.low + gloss_f90_ * a.high; }
  /// Returns the mean reflectance of all facets.
  [[nodiscard]] Vec3 mean_facet() const { return f0_ + (Vec3::Constant(f90_) - f0_) * kMeanSchlick; }
  [[nodiscard]] const Vec3& gloss_albedo() const { return gloss_albedo_; }
  [[nodiscard]] const Vec3& more_albedo() const { return more_albedo_; }
  [[nodiscard]] const Vec3& diffuse_albedo() const { return diffuse_albedo_; }

 private:
  /// Returns the total reflectance of the dielectric's gloss: its largest component, so that a tinted gloss does not
  /// tint the layer below.
  [[nodiscard]] float reflected(const BounceAlbedo& a) const {
    return gloss_f0_ * a.low + gloss_f90_ * a.high + gloss_more_ * a.lost;
  }

  AlbedoRow row_;
  Vec3 f0_;
  float f90_;
  Vec3 diffuse_;
  float gloss_f0_;
  float gloss_f90_;
  Vec3 more_;
  float gloss_more_ = 0.0f;
  Vec3 gloss_albedo_;
  Vec3 more_albedo_;
  Vec3 diffuse_albedo_;
};

}  // namespace cyclorama::render
