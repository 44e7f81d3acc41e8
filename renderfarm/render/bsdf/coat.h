// SPDX-License-Identifier: Apache-2.0
/// KHR_materials_clearcoat: a colourless top lobe with an index of refraction of 1.5, and the attenuation of the layers
/// below it.
///
/// The extension attenuates the layers below by the viewer's angle alone; here the attenuation is reciprocal. For wide
/// lobes below the coat, it is the product of the attenuations at both angles, divided by their mean over the
/// hemisphere. For narrow lobes, whose two angles are nearly equal, it is the smaller of both attenuations.
#pragma once

#include "renderfarm/render/bsdf/albedo_table.h"
#include "renderfarm/render/bsdf/bsdf.h"
#include "renderfarm/render/bsdf/fresnel.h"
#include "renderfarm/render/bsdf/microfacet.h"

namespace cyclorama::render {

/// A clear coat. Directions are in the frame of `normal`, not in the local frame of the surface. Seen from inside a
/// body, the coat only attenuates. Thread-bound.
class Coat {
 public:
  Coat(const Bsdf& bsdf, const Vec3& normal, const Vec3& wo)
      : part_(bsdf.coat),
        frame_(bsdf.coat_normal.isZero(0.0f) ? normal : bsdf.coat_normal),
        wo_(seen_from_above(frame_.to_local(wo))),
        mirror_(!(bsdf.coat_alpha > 0.0f)),
        shines_(part_ > 0.0f && !bsdf.inside),
        facets_(bsdf.coat_alpha, wo_),
        row_(bsdf.coat_alpha) {
    if (!(part_ > 0.0f)) return;
    const float cos_o = frame_.to_local(wo).z();
    kept_ = kept(std::abs(cos_o));
    faces_ = shines_ && cos_o > 0.0f;
    const BounceAlbedo mean = row_.mean();
    mean_kept_ = 1.0f - part_ * (kCoatF0 * mean.low + mean.high);
  }

  /// Returns the coated share of the surface; zero if the coat is not visible.
  [[nodiscard]] float part() const { return shines_ ? part_ : 0.0f; }
  [[nodiscard]] bool is_mirror() const { return mirror_; }
  /// Returns the share that the coat reflects under uniform illumination.
  [[nodiscard]] float albedo() const { return faces_ ? 1.0f - kept_ : 0.0f; }
  /// Returns the attenuation of a narrow lobe below the coat, from wo to wi.
  [[nodiscard]] float narrow(const Vec3& wi) const { return shines_ ? std::min(kept_, kept(cosine(wi))) : 1.0f; }
  [[nodiscard]] float wide(const Vec3& wi) const {
    return shines_ ? kept_ * kept(cosine(wi)) / std::max(1e-6f, mean_kept_) : 1.0f;
  }
  /// Returns the attenuation of light that enters or leaves a body: only the outside direction crosses the coat.
  [[nodiscard]] float crossed(const Vec3& wi) const {
    if (!(part_ > 0.0f)) return 1.0f;
    return shines_ ? kept_ : kept(cosine(wi));
  }
  /// Returns an approximate mean of narrow() and wide().
  [[nodiscard]] float left() const { return shines_ ? kept_ : 1.0f; }

  /// Returns the BRDF times the cosine of `wi`; zero if the coat is a mirror.
  [[nodiscard]] float evaluate(const Vec3& wi) const {
    if (!faces_ || mirror_) return 0.0f;
    const Vec3 local = frame_.to_local(wi);
    if (!(local.z() > 0.0f)) return 0.0f;
    const Vec3 h = normalized_or(wo_ + local, Vec3::UnitZ());
    return facet(local.dot(h)) * facets_.pdf(h) * facets_.visibility(local.z()) * local.z();
  }
  [[nodiscard]] float pdf(const Vec3& wi) const {
    if (!faces_ || mirror_) return 0.0f;
    const Vec3 local = frame_.to_local(wi);
    if (!(local.z() > 0.0f)) return 0.0f;
    return facets_.reflected_pdf(facets_.pdf(normalized_or(wo_ + local, Vec3::UnitZ())), true);
  }
  [[nodiscard]] Vec3 sample(const Vec2& u) const {
    const Vec3 h = mirror_ ? Vec3(Vec3::UnitZ()) : facets_.sample(u, true);
    return frame_.from_local(normalized_or(2.0f * wo_.dot(h) * h - wo_, Vec3::UnitZ()));
  }
  [[nodiscard]] float mirrored() const { return facet(wo_.z()); }

 private:
  [[nodiscard]] float facet(float cosine) const { return part_ * (kCoatF0 + (1.0f - kCoatF0) * schlick(cosine)); }
  [[nodiscard]] float cosine(const Vec3& wi) const { return std::abs(frame_.to_local(wi).z()); }
  [[nodiscard]] float kept(float cosine) const {
    const BounceAlbedo a = row_.at(cosine);
    return 1.0f - part_ * (kCoatF0 * a.low + a.high);
  }

  float part_;
  Frame frame_;
  Vec3 wo_;
  bool mirror_;
  bool shines_;         ///< The coat is seen from outside a body.
  bool faces_ = false;  ///< The coat is also seen from the side of its own normal.
  Microfacets facets_;
  AlbedoRow row_;
  float kept_ = 1.0f;
  float mean_kept_ = 1.0f;
};

}  // namespace cyclorama::render
