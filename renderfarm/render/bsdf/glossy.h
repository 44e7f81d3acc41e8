// SPDX-License-Identifier: Apache-2.0
/// Scattering of opaque surfaces: a GGX lobe and a wide lobe.
#pragma once

#include "renderfarm/render/bsdf/microfacet.h"
#include "renderfarm/render/bsdf/opaque_base.h"
#include "renderfarm/render/bsdf/scattering.h"

namespace cyclorama::render {

template <>
class Scattering<SurfaceLevel::kGlossy> {
 public:
  Scattering(const Bsdf& bsdf, const Vec3& normal, const Vec3& wo)
      : frame_(normal),
        wo_(seen_from_above(frame_.to_local(wo))),
        mirror_(!(bsdf.alpha > 0.0f)),
        facets_(bsdf.alpha, wo_),
        grazing_(bsdf.alpha),
        base_(bsdf, wo_.z(), 1.0f - bsdf.metallic, 1.0f - bsdf.metallic) {
    const float gloss = luminance(base_.gloss_albedo());
    const float more = luminance(base_.more_albedo());
    const float sum = gloss + more + luminance(base_.diffuse_albedo());
    if (sum > 0.0f) {
      gloss_chance_ = gloss / sum;
      more_chance_ = more / sum;
    }
  }

  [[nodiscard]] Vec3 evaluate(const Vec3& wi) const { return evaluate_local(frame_.to_local(wi)); }
  [[nodiscard]] float pdf(const Vec3& wi) const { return pdf_local(frame_.to_local(wi)); }

  [[nodiscard]] ScatterSample sample(const Vec2& u, float choice) const {
    ScatterSample sample;
    Vec3 wi;
    if (choice < gloss_chance_) {
      if (mirror_) {
        sample.wi = frame_.from_local({-wo_.x(), -wo_.y(), wo_.z()});
        sample.weight = base_.facet(wo_.z()) / gloss_chance_;
        return sample;
      }
      const Vec3 h = facets_.sample(u, true);
      wi = normalized_or(2.0f * wo_.dot(h) * h - wo_, Vec3::UnitZ());
    } else {
      wi = choice < gloss_chance_ + more_chance_ ? grazing_.sample(u) : cosine_hemisphere(u);
    }
    sample.wi = frame_.from_local(wi);
    sample.pdf = pdf_local(wi);
    if (sample.pdf > 0.0f) sample.weight = evaluate_local(wi) / sample.pdf;
    return sample;
  }

  [[nodiscard]] Vec3 albedo() const { return base_.gloss_albedo() + base_.more_albedo() + base_.diffuse_albedo(); }
  /// Returns the albedo without the glossy lobe.
  [[nodiscard]] Vec3 wide_albedo() const { return base_.more_albedo() + base_.diffuse_albedo(); }

 private:
  friend class GlossyLobe;
  [[nodiscard]] Vec3 evaluate_local(const Vec3& wi) const {
    if (!(wi.z() > 0.0f)) return Vec3::Zero();
    const Vec3 wide = base_.wide(wi.z()) * (wi.z() / kPi);
    if (mirror_) return wide;
    const Vec3 h = normalized_or(wo_ + wi, Vec3::UnitZ());
    return wide + base_.facet(wi.dot(h)) * (facets_.pdf(h) * facets_.visibility(wi.z()) * wi.z());
  }

  [[nodiscard]] float pdf_local(const Vec3& wi) const {
    if (!(wi.z() > 0.0f)) return 0.0f;
    const float diffuse = (1.0f - gloss_chance_ - more_chance_) * wi.z() / kPi;
    if (mirror_) return diffuse;
    const float wide = diffuse + more_chance_ * grazing_.pdf(wi.z());
    const Vec3 h = normalized_or(wo_ + wi, Vec3::UnitZ());
    return wide + gloss_chance_ * facets_.reflected_pdf(facets_.pdf(h), true);
  }

  Frame frame_;
  Vec3 wo_;
  bool mirror_;
  Microfacets facets_;
  GrazingLobe grazing_;
  OpaqueBase base_;
  float gloss_chance_ = 0.0f;
  float more_chance_ = 0.0f;
};

/// The glossy lobe alone, with the functions of Scattering; wide_albedo() is the albedo of the other lobes. Borrows
/// `whole`.
class GlossyLobe {
 public:
  explicit GlossyLobe(const Scattering<SurfaceLevel::kGlossy>& whole) : s_(whole) {}

  [[nodiscard]] Vec3 evaluate(const Vec3& wi) const {
    const Vec3 local = s_.frame_.to_local(wi);
    if (s_.mirror_ || !(local.z() > 0.0f)) return Vec3::Zero();
    const Vec3 h = normalized_or(s_.wo_ + local, Vec3::UnitZ());
    return s_.base_.facet(local.dot(h)) * (s_.facets_.pdf(h) * s_.facets_.visibility(local.z()) * local.z());
  }
  [[nodiscard]] float pdf(const Vec3& wi) const {
    const Vec3 local = s_.frame_.to_local(wi);
    if (s_.mirror_ || !(local.z() > 0.0f)) return 0.0f;
    return s_.facets_.reflected_pdf(s_.facets_.pdf(normalized_or(s_.wo_ + local, Vec3::UnitZ())), true);
  }
  [[nodiscard]] ScatterSample sample(const Vec2& u, float /*choice*/) const {
    ScatterSample sample;
    if (s_.mirror_) {
      sample.wi = s_.frame_.from_local({-s_.wo_.x(), -s_.wo_.y(), s_.wo_.z()});
      sample.weight = s_.base_.facet(s_.wo_.z());
      return sample;
    }
    const Vec3 h = s_.facets_.sample(u, true);
    sample.wi = s_.frame_.from_local(normalized_or(2.0f * s_.wo_.dot(h) * h - s_.wo_, Vec3::UnitZ()));
    sample.pdf = pdf(sample.wi);
    if (sample.pdf > 0.0f) sample.weight = evaluate(sample.wi) / sample.pdf;
    return sample;
  }

 private:
  const Scattering<SurfaceLevel::kGlossy>& s_;
};

}  // namespace cyclorama::render
