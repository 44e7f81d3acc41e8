// SPDX-License-Identifier: Apache-2.0
/// The interface of Scattering at every level, and its matte specialisation.
///
/// A Scattering describes a surface seen from `wo`. All directions are unit vectors that point away from the surface;
/// `normal` is the shading normal on the side of `wo`. The caller checks on which side of the triangle a direction is.
/// Reentrant.
///
/// The transported quantity is radiance over the square of the index of refraction. This quantity does not change where
/// light enters or leaves a body, so white glass under uniform illumination is white. In air it equals radiance.
#pragma once

#include "renderfarm/render/bsdf/bsdf.h"

namespace cyclorama::render {

/// A sampled direction of incident light.
struct ScatterSample {
  Vec3 wi = Vec3::UnitZ();
  /// BSDF times cosine over pdf. If zero, light is absorbed and the other fields are undefined.
  Vec3 weight = Vec3::Zero();
  float pdf = 0.0f;            ///< Scattering::pdf(wi); 0 for a mirror or clear glass, which evaluate() excludes.
  bool through = false;        ///< `wi` is on the side opposite to the viewer's.
};

template <SurfaceLevel kLevel>
class Scattering;

template <>
class Scattering<SurfaceLevel::kMatte> {
 public:
  Scattering(const Bsdf& bsdf, const Vec3& normal, const Vec3& /*wo*/) : albedo_(bsdf.base_colour), n_(normal) {}

  /// Returns BSDF times the cosine of `wi`, excluding mirrors.
  [[nodiscard]] Vec3 evaluate(const Vec3& wi) const { return albedo_ * pdf(wi); }
  /// Returns the pdf of sample() per steradian, excluding mirrors.
  [[nodiscard]] float pdf(const Vec3& wi) const { return std::max(0.0f, n_.dot(wi)) * (1.0f / kPi); }
  /// Samples a direction; `u` and `choice` are in [0, 1).
  [[nodiscard]] ScatterSample sample(const Vec2& u, float /*choice*/) const {
    const Vec3 wi = from_frame_of(n_, cosine_hemisphere(u));
    return {wi, albedo_, pdf(wi), false};
  }
  /// Returns the light reflected and transmitted under uniform illumination, including mirrors.
  [[nodiscard]] Vec3 albedo() const { return albedo_; }

 private:
  Vec3 albedo_;
  Vec3 n_;
};

}  // namespace cyclorama::render
