// SPDX-License-Identifier: Apache-2.0
/// Microfacets of a transmissive surface, which reflect or transmit light. Vectors are in the surface's local frame.
///
/// A thin surface (KHR_materials_transmission) is a sheet of glass that does not change the direction of light;
/// roughness blurs transmitted light as it blurs reflected light. A body (KHR_materials_volume) refracts light by
/// Snell's law (Walter et al. 2007).
#pragma once

#include "renderfarm/render/bsdf/microfacet.h"
#include "renderfarm/render/bsdf/opaque_base.h"

namespace cyclorama::render {

/// Reflectance and transmittance of a facet, per colour channel.
struct FacetShare {
  Vec3 mirrored = Vec3::Zero();
  Vec3 passed = Vec3::Zero();
  float beyond = 1.0f;  ///< Cosine between the facet's normal and the refracted direction; bodies only.

  /// Returns the probability with which a sample is reflected.
  [[nodiscard]] float mirror_chance() const {
    const float mirror = luminance(mirrored);
    const float pass = luminance(passed);
    return mirror + pass > 0.0f ? mirror / (mirror + pass) : 1.0f;
  }
};

/// A change of direction at a facet.
struct FacetTurn {
  Vec3 h = Vec3::UnitZ();
  float o_h = 1.0f;
  float jacobian = 0.0f;  ///< Solid angle of h per solid angle of wi. Zero if no facet causes this change.
};

/// Reflection and transmission of the facets of one material. Thread-bound.
class Interface {
 public:
  Interface(const Bsdf& bsdf, const OpaqueBase& base)
      : base_(base),
        passing_(bsdf.base_colour * (bsdf.transmission * (1.0f - bsdf.metallic))),
        part_(bsdf.transmission * (1.0f - bsdf.metallic)),
        f0_(bsdf.f0),
        f90_(bsdf.specular),
        thin_f90_(bsdf.f90),
        body_(!bsdf.thin && part_ > 0.0f),
        eta_(bsdf.inside ? 1.0f / bsdf.ior : bsdf.ior) {
    constexpr float kMinIorContrast = 1e-3f;  // Below it, Snell's law needs more precision than float has.
    straight_ = body_ && bsdf.ior < 1.0f + kMinIorContrast;
    const float root = (bsdf.ior - 1.0f) / (bsdf.ior + 1.0f);
    plain_f0_ = root * root;
  }

  [[nodiscard]] bool passes() const { return part_ > 0.0f; }
  [[nodiscard]] bool is_body() const { return body_; }
  /// Returns true for a body of air, which light crosses unchanged whatever the roughness.
  [[nodiscard]] bool is_straight() const { return straight_; }
  [[nodiscard]] float part() const { return part_; }
  [[nodiscard]] const Vec3& passing() const { return passing_; }
  [[nodiscard]] float eta() const { return eta_; }

  [[nodiscard]] FacetShare at(float o_h) const {
    FacetShare share;
    share.mirrored = base_.facet(o_h);
    if (!passes() || straight_) return share;
    if (!body_) {
      const float grazing = schlick(o_h);
      const float max = f0_.maxCoeff() * (1.0f - grazing) + thin_f90_ * grazing;
      share.passed = passing_ * (1.0f - max);
      return share;
    }
    const float plain = dielectric_reflectance(o_h, eta_, &share.beyond);
    if (share.beyond == 0.0f) {
      share.mirrored += Vec3::Constant(part_);
      return share;
    }
    // The exact Fresnel curve replaces Schlick's fit between glTF's f0 and f90, so that a body with an ior of 1 is
    // invisible.
    const float grazing = plain_f0_ < 0.9999f ? std::clamp((plain - plain_f0_) / (1.0f - plain_f0_), 0.0f, 1.0f) : 1.0f;
    const Vec3 reflectance = f0_ * (1.0f - grazing) + Vec3::Constant(f90_ * grazing);
    share.mirrored += reflectance * part_;
    share.passed = passing_ * (1.0f - reflectance.maxCoeff());
    return share;
  }

  /// Returns the facet that transmits light from `wi`, below the surface, to `wo`.
  [[nodiscard]] FacetTurn turn(const Vec3& wo, const Vec3& wi) const {
    FacetTurn turn;
    if (!body_) {
      turn.h = normalized_or(wo + Vec3(wi.x(), wi.y(), -wi.z()), Vec3::UnitZ());
      turn.o_h = wo.dot(turn.h);
      turn.jacobian = turn.o_h > 0.0f ? 0.25f / turn.o_h : 0.0f;
      return turn;
    }
    turn.h = normalized_or(wo + eta_ * wi, Vec3::UnitZ());
    if (turn.h.z() < 0.0f) turn.h = -turn.h;
    turn.o_h = wo.dot(turn.h);
    const float i_h = wi.dot(turn.h);
    if (!(turn.o_h > 0.0f) || !(i_h < 0.0f)) return turn;
    const float sum = i_h + turn.o_h / eta_;
    if (sum != 0.0f) turn.jacobian = -i_h / (sum * sum);
    return turn;
  }
  /// Returns the direction in which a facet transmits light.
  [[nodiscard]] Vec3 pass(const Vec3& wo, const Vec3& h, const FacetShare& share) const {
    const float o_h = wo.dot(h);
    if (body_) return normalized_or((o_h / eta_ - share.beyond) * h - wo / eta_, -wo);
    const Vec3 mirrored = normalized_or(2.0f * o_h * h - wo, Vec3::UnitZ());
    return {mirrored.x(), mirrored.y(), -mirrored.z()};
  }

 private:
  const OpaqueBase& base_;
  Vec3 passing_;
  float part_;
  Vec3 f0_;
  float f90_;
  float thin_f90_;
  float plain_f0_ = 0.0f;
  bool body_;
  bool straight_ = false;
  float eta_;
};

}  // namespace cyclorama::render
