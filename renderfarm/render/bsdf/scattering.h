// SPDX-License-Identifier: Apache-2.0
/// What every level's Scattering offers, and the matte one.
///
/// A surface seen from `wo`. All directions are unit vectors that point away from it; `normal` is the shading normal on
/// wo's side. Which side of the triangle itself a direction is on is the caller's to check. Reentrant.
///
/// What travels is radiance over the square of the index of refraction: it stays the same where light enters a body and
/// leaves it again, so that white glass in even light is white. An eye and lamps in air see no difference.
#pragma once

#include "renderfarm/render/bsdf/bsdf.h"

namespace cyclorama {

/// A direction for light from all around.
struct ScatterSample {
  Vec3 wi = Vec3::UnitZ();
  Vec3 weight = Vec3::Zero();  ///< BSDF times cosine, over density. Zero: absorbed, and the rest says nothing.
  float density = 0.0f;        ///< As density(wi). 0: a mirror, or clear glass; evaluate() knows nothing of it.
  bool through = false;        ///< wi is on the other side of the surface.
};

template <SurfaceLevel kLevel>
class Scattering;

template <>
class Scattering<SurfaceLevel::kMatte> {
 public:
  Scattering(const Bsdf& bsdf, const Vec3& normal, const Vec3& /*wo*/) : albedo_(bsdf.base_colour), n_(normal) {}

  /// BSDF times the cosine of `wi`, without mirrors.
  [[nodiscard]] Vec3 evaluate(const Vec3& wi) const { return albedo_ * density(wi); }
  /// Of sample(), per steradian, without mirrors.
  [[nodiscard]] float density(const Vec3& wi) const { return std::max(0.0f, n_.dot(wi)) * (1.0f / kPi); }
  /// `u` and `choice` in [0, 1).
  [[nodiscard]] ScatterSample sample(const Vec2& u, float /*choice*/) const {
    const Vec3 wi = from_frame_of(n_, cosine_hemisphere(u));
    return {wi, albedo_, density(wi), false};
  }
  /// What comes back, and through, of light that is the same from everywhere; mirrors included.
  [[nodiscard]] Vec3 albedo() const { return albedo_; }

 private:
  Vec3 albedo_;
  Vec3 n_;
};

}  // namespace cyclorama
