// SPDX-License-Identifier: Apache-2.0
/// Points, spots, spheres and suns: KHR_lights_punctual with a size.
#pragma once

#include "renderfarm/render/lights/light_sample.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::render {

/// A lamp in the render frame.
struct Lamp {
  scene::LightKind kind = scene::LightKind::kPoint;
  Vec3 position = Vec3::Zero();
  Vec3 axis = Vec3(0.0f, -1.0f, 0.0f);  ///< Direction of emission.
  Vec3 intensity = Vec3::Zero();        ///< Candela; lux for directional lamps.
  float power = 0.0f;                   ///< Luminance of the intensity.
  float radius = 0.0f;                  ///< Point and spot: radius of the sphere in metres.
  float inverse_range = 0.0f;           ///< Inverse of the range, in 1/m; 0 for no limit.
  float cos_outer = -1.0f;              ///< Spot: cosine of the outer cone's half angle.
  float inverse_cone = 1.0f;            ///< Spot: 1 / (cos inner - cos outer).
  float one_minus_cos_disc = 0.0f;      ///< Directional: 1 - cosine of the disc's angular radius.
  float sin_disc = 0.0f;                ///< Directional: sine of the disc's angular radius.
  bool visible = false;                 ///< Rays can hit the lamp.
  std::size_t group = 0;                ///< See scene/lamp_groups.h.
};

/// Lower bound of distances, in metres, that keeps the light of point lamps finite.
inline constexpr float kMinLampDistance = 1e-3f;

/// Returns the lamp in the render frame, whose origin is `origin`. Precondition: `light` is a point, spot or
/// directional light.
[[nodiscard]] Lamp make_lamp(const scene::Light& light, const Eigen::Vector3d& origin);
/// Returns true if the lamp has finite parameters and emits light.
[[nodiscard]] bool is_lit(const Lamp& lamp);

/// Samples a position on the lamp, uniform in solid angle as seen from `p`; for a directional lamp, a direction within
/// its disc. If `p` is inside the lamp's sphere, light comes from all directions.
[[nodiscard]] LightSample sample_lamp(const Lamp& lamp, const Vec3& p, const Vec2& u);
/// Returns the pdf of sample_lamp() for a ray that hit the lamp.
[[nodiscard]] float lamp_pdf(const Lamp& lamp, const Vec3& p);
/// Returns the radiance of the lamp's sphere, seen from `p`.
[[nodiscard]] Vec3 lamp_radiance(const Lamp& lamp, const Vec3& p);

/// Returns KHR_lights_punctual's attenuation towards the range, without 1/d^2.
[[nodiscard]] inline float fading(const Lamp& lamp, float distance) {
  const float part = distance * lamp.inverse_range;
  const float part2 = part * part;
  return std::clamp(1.0f - part2 * part2, 0.0f, 1.0f);
}

[[nodiscard]] inline float spot_factor(const Lamp& lamp, const Vec3& to_lamp) {
  if (lamp.kind != scene::LightKind::kSpot) return 1.0f;
  const float inside = std::clamp((-lamp.axis.dot(to_lamp) - lamp.cos_outer) * lamp.inverse_cone, 0.0f, 1.0f);
  return inside * inside;
}

}  // namespace cyclorama::render
