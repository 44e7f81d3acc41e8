// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/lights/lamp.h"

#include <cmath>

namespace cyclorama::render {
namespace {

/// Squared sine of the half angle below which a sphere is treated as a point, because its cap is too small for float's
/// precision.
constexpr float kMinSine2 = 1e-12f;

/// The lamp's sphere as seen from a point.
struct SphereView {
  Vec3 to_centre = Vec3::UnitY();
  float distance = 0.0f;
  float sine2 = 0.0f;  ///< Squared sine of half the angle that it subtends; 0 for a point.
  float one_minus_cos = 0.0f;
  bool inside = false;
};

SphereView view_of(const Lamp& lamp, const Vec3& p) {
  SphereView view;
  const Vec3 offset = lamp.position - p;
  const float distance2 = offset.squaredNorm();
  const float radius2 = lamp.radius * lamp.radius;
  view.inside = lamp.radius > 0.0f && distance2 <= radius2;
  view.distance = std::max(std::sqrt(distance2), kMinLampDistance);
  view.to_centre = normalized_or(offset, Vec3::UnitY());
  if (view.inside) return view;
  const float sine2 = std::min(1.0f, radius2 / (view.distance * view.distance));
  if (!(sine2 > kMinSine2)) return view;
  view.sine2 = sine2;
  view.one_minus_cos = sine2 / (1.0f + std::sqrt(1.0f - sine2));
  return view;
}

Vec3 intensity_towards(const Lamp& lamp, const SphereView& view) {
  return lamp.intensity * (fading(lamp, view.distance) * spot_factor(lamp, view.to_centre));
}

LightSample sample_disc(const Lamp& lamp, const Vec2& u) {
  const Vec3 centre = -lamp.axis;
  const Vec3 direction = lamp.sin_disc > 0.0f ? from_frame_of(centre, uniform_cap(u, lamp.one_minus_cos_disc)) : centre;
  return {direction, kEndless, lamp.intensity, 0.0f};
}

/// Samples the emitting sphere from inside, where its surface fills all directions.
LightSample sample_from_inside(const Lamp& lamp, const Vec3& p, const Vec2& u) {
  const Vec3 to_centre = lamp.position - p;
  const Vec3 direction = uniform_cap(u, 2.0f);
  const float along = direction.dot(to_centre);
  const float out = std::sqrt(std::max(0.0f, lamp.radius * lamp.radius - to_centre.squaredNorm() + along * along));
  const float pdf = 1.0f / (4.0f * kPi);
  return {direction, short_of(p, std::max(0.0f, along + out), out / lamp.radius), lamp_radiance(lamp, p) / pdf,
          lamp.visible ? pdf : 0.0f};
}

}  // namespace

Lamp make_lamp(const scene::Light& light, const Eigen::Vector3d& origin) {
  Lamp lamp;
  lamp.kind = light.kind;
  lamp.position = (light.position - origin).cast<float>();
  lamp.axis = normalized_or(light.direction.cast<float>(), Vec3(0.0f, -1.0f, 0.0f));
  lamp.intensity = light.intensity.cwiseMax(0.0f);
  lamp.power = luminance(lamp.intensity);
  if (light.kind == scene::LightKind::kDirectional) {
    const double angle = std::atan(std::max(0.0, light.radius_m));
    lamp.sin_disc = static_cast<float>(std::sin(angle));
    lamp.one_minus_cos_disc = static_cast<float>(2.0 * std::pow(std::sin(0.5 * angle), 2.0));
    return lamp;
  }
  lamp.radius = static_cast<float>(std::max(0.0, light.radius_m));
  if (!std::isnormal(lamp.radius * lamp.radius)) lamp.radius = 0.0f;
  lamp.visible = light.visible && lamp.radius > 0.0f;
  lamp.group = light.group;
  if (light.range_m > 0.0) lamp.inverse_range = static_cast<float>(1.0 / light.range_m);
  const double cos_outer = std::cos(light.outer_cone_rad);
  const double cos_inner = std::cos(std::min(light.inner_cone_rad, light.outer_cone_rad));
  lamp.cos_outer = static_cast<float>(cos_outer);
  lamp.inverse_cone = static_cast<float>(1.0 / std::max(1e-4, cos_inner - cos_outer));
  return lamp;
}

bool is_lit(const Lamp& lamp) {
  return lamp.power > 0.0f && std::isfinite(lamp.power) && is_finite(lamp.intensity) && is_finite(lamp.position);
}

LightSample sample_lamp(const Lamp& lamp, const Vec3& p, const Vec2& u) {
  if (lamp.kind == scene::LightKind::kDirectional) return sample_disc(lamp, u);
  const SphereView view = view_of(lamp, p);
  if (view.inside) return sample_from_inside(lamp, p, u);
  const Vec3 shining = intensity_towards(lamp, view);
  if (!(view.sine2 > 0.0f)) {
    return {view.to_centre, short_of(p, std::max(0.0f, view.distance - lamp.radius), 1.0f),
            shining / (view.distance * view.distance), 0.0f};
  }
  // The sphere fills a cap; radiance is intensity / (pi r^2), pdf 1 / (2 pi (1 - cos)).
  const Vec3 local = uniform_cap(u, view.one_minus_cos);
  const float radius2 = lamp.radius * lamp.radius;
  const float along = view.distance * local.z();
  const float miss2 = local.head<2>().squaredNorm() * view.distance * view.distance;
  const float deep = std::sqrt(std::max(0.0f, radius2 - miss2));
  return {from_frame_of(view.to_centre, local), short_of(p, std::max(0.0f, along - deep), deep / lamp.radius),
          shining * (2.0f * view.one_minus_cos / radius2), lamp_pdf(lamp, p)};
}

float lamp_pdf(const Lamp& lamp, const Vec3& p) {
  if (!lamp.visible) return 0.0f;
  const SphereView view = view_of(lamp, p);
  if (view.inside) return 1.0f / (4.0f * kPi);
  return view.sine2 > 0.0f ? 1.0f / (2.0f * kPi * view.one_minus_cos) : 0.0f;
}

Vec3 lamp_radiance(const Lamp& lamp, const Vec3& p) {
  if (!(lamp.radius > 0.0f)) return Vec3::Zero();
  const SphereView view = view_of(lamp, p);
  // Light sampling accounts for all the light of a sphere that it treats as a point, so a ray that hits the sphere adds
  // nothing.
  if (!view.inside && !(view.sine2 > 0.0f)) return Vec3::Zero();
  const Vec3 shining = view.inside ? lamp.intensity : intensity_towards(lamp, view);
  return shining / (kPi * lamp.radius * lamp.radius);
}

}  // namespace cyclorama::render
