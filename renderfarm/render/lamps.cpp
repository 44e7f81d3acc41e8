// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/lamps.h"

#include <array>
#include <cmath>
#include <limits>

namespace cyclorama {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Nearer to a lamp without a size, its light would grow without bound.
constexpr float kLeastDistance = 1e-3f;
/// Estimates are kept for this many lamps while one is chosen; those of others are made twice.
constexpr std::size_t kRemembered = 64;

/// KHR_lights_punctual's fading towards the range, without the 1/d^2.
float fading(const Lamp& lamp, float distance) {
  const float part = distance * lamp.inverse_range;
  const float part2 = part * part;
  return std::clamp(1.0f - part2 * part2, 0.0f, 1.0f);
}

float spot_factor(const Lamp& lamp, const Vec3& to_lamp) {
  if (lamp.kind != LightKind::kSpot) return 1.0f;
  const float inside = std::clamp((-lamp.axis.dot(to_lamp) - lamp.cos_outer) * lamp.inverse_cone, 0.0f, 1.0f);
  return inside * inside;
}

Lamp make_lamp(const Light& light, const Eigen::Vector3d& origin) {
  Lamp lamp;
  lamp.kind = light.kind;
  lamp.position = (light.position - origin).cast<float>();
  lamp.axis = normalized_or(light.direction.cast<float>(), Vec3(0.0f, -1.0f, 0.0f));
  lamp.intensity = light.intensity.cwiseMax(0.0f);
  lamp.power = luminance(lamp.intensity);
  if (light.kind == LightKind::kDirectional) {
    const double angle = std::atan(std::max(0.0, light.radius_m));
    lamp.sin_disc = static_cast<float>(std::sin(angle));
    lamp.one_minus_cos_disc = static_cast<float>(2.0 * std::pow(std::sin(0.5 * angle), 2.0));
    return lamp;
  }
  lamp.radius = static_cast<float>(std::max(0.0, light.radius_m));
  if (light.range_m > 0.0) lamp.inverse_range = static_cast<float>(1.0 / light.range_m);
  const double cos_outer = std::cos(light.outer_cone_rad);
  const double cos_inner = std::cos(std::min(light.inner_cone_rad, light.outer_cone_rad));
  lamp.cos_outer = static_cast<float>(cos_outer);
  lamp.inverse_cone = static_cast<float>(1.0 / std::max(1e-4, cos_inner - cos_outer));
  return lamp;
}

LampAim aim_at_disc(const Lamp& lamp, const Vec2& u) {
  const Vec3 centre = -lamp.axis;
  const Vec3 direction = lamp.sin_disc > 0.0f ? from_frame_of(centre, uniform_cap(u, lamp.one_minus_cos_disc)) : centre;
  return {direction, kInfinity, lamp.intensity};
}

/// From inside the shining sphere: its surface, seen all around.
LampAim aim_from_inside(const Lamp& lamp, const Vec3& to_centre, const Vec2& u) {
  const Vec3 direction = uniform_cap(u, 2.0f);
  const float along = direction.dot(to_centre);
  const float out = std::sqrt(std::max(0.0f, lamp.radius * lamp.radius - to_centre.squaredNorm() + along * along));
  const Vec3 radiance = lamp.intensity / (kPi * lamp.radius * lamp.radius);
  return {direction, std::max(0.0f, along + out), radiance * (4.0f * kPi)};
}

}  // namespace

std::vector<Lamp> make_lamps(const std::vector<Light>& lights, const Eigen::Vector3d& origin) {
  std::vector<Lamp> lamps;
  for (const Light& light : lights) {
    if (is_flat(light.kind)) continue;
    const Lamp lamp = make_lamp(light, origin);
    if (lamp.power > 0.0f && std::isfinite(lamp.power) && is_finite(lamp.position)) lamps.push_back(lamp);
  }
  return lamps;
}

float estimate(const Lamp& lamp, const Vec3& p, const Vec3& n) {
  if (lamp.kind == LightKind::kDirectional) {
    return lamp.power * std::clamp(lamp.sin_disc - n.dot(lamp.axis), 0.0f, 1.0f);
  }
  const Vec3 offset = lamp.position - p;
  const float distance2 = offset.squaredNorm();
  const float radius2 = lamp.radius * lamp.radius;
  if (distance2 <= radius2) return lamp.power / radius2;
  const float distance = std::max(std::sqrt(distance2), kLeastDistance);
  const Vec3 to_lamp = offset / distance;
  const float cosine = std::clamp(n.dot(to_lamp) + lamp.radius / distance, 0.0f, 1.0f);
  return lamp.power * cosine * fading(lamp, distance) * spot_factor(lamp, to_lamp) / (distance * distance);
}

LampAim aim(const Lamp& lamp, const Vec3& p, const Vec2& u) {
  if (lamp.kind == LightKind::kDirectional) return aim_at_disc(lamp, u);
  const Vec3 offset = lamp.position - p;
  const float distance2 = offset.squaredNorm();
  const float radius2 = lamp.radius * lamp.radius;
  if (distance2 <= radius2 && lamp.radius > 0.0f) return aim_from_inside(lamp, offset, u);

  const float distance = std::max(std::sqrt(distance2), kLeastDistance);
  const Vec3 to_lamp = normalized_or(offset, Vec3::UnitY());
  const Vec3 shining = lamp.intensity * (fading(lamp, distance) * spot_factor(lamp, to_lamp));
  if (!(lamp.radius > 0.0f)) return {to_lamp, distance, shining / (distance * distance)};

  // The sphere fills a cap; radiance is intensity / (pi r^2), density 1 / (2 pi (1 - cos)).
  const float sine2 = radius2 / (distance * distance);
  const float cosine = std::sqrt(std::max(0.0f, 1.0f - sine2));
  const float one_minus_cos = sine2 / (1.0f + cosine);
  const Vec3 local = uniform_cap(u, one_minus_cos);
  const float along = distance * local.z();
  const float miss2 = local.head<2>().squaredNorm() * distance * distance;
  const float surface = along - std::sqrt(std::max(0.0f, radius2 - miss2));
  return {from_frame_of(to_lamp, local), std::max(0.0f, surface), shining * (2.0f * one_minus_cos / radius2)};
}

int choose_lamp(const std::vector<Lamp>& lamps, const Vec3& p, const Vec3& n, float u, float* ret_probability) {
  std::array<float, kRemembered> remembered;
  float total = 0.0f;
  for (std::size_t i = 0; i < lamps.size(); ++i) {
    const float e = estimate(lamps[i], p, n);
    if (i < kRemembered) remembered[i] = e;
    total += e;
  }
  if (!(total > 0.0f) || !std::isfinite(total)) return -1;
  float left = u * total;
  int chosen = -1;
  for (std::size_t i = 0; i < lamps.size(); ++i) {
    const float e = i < kRemembered ? remembered[i] : estimate(lamps[i], p, n);
    if (!(e > 0.0f)) continue;
    // Rounding may leave a rest after the last one: it belongs to the last.
    chosen = static_cast<int>(i);
    *ret_probability = e / total;
    left -= e;
    if (left < 0.0f) break;
  }
  return chosen;
}

}  // namespace cyclorama
