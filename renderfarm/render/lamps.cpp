// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/lamps.h"

#include <array>
#include <cmath>

namespace cyclorama {
namespace {

/// Estimates are kept for this many lamps while one is chosen; those of others are made twice.
constexpr std::size_t kRemembered = 64;

}  // namespace

std::vector<Lamp> make_lamps(const std::vector<Light>& lights, const Eigen::Vector3d& origin) {
  std::vector<Lamp> lamps;
  for (const Light& light : lights) {
    if (is_flat(light.kind)) continue;
    const Lamp lamp = make_lamp(light, origin);
    if (is_lit(lamp)) lamps.push_back(lamp);
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
  const float distance = std::max(std::sqrt(distance2), kLeastLampDistance);
  const Vec3 to_lamp = offset / distance;
  const float cosine = std::clamp(n.dot(to_lamp) + lamp.radius / distance, 0.0f, 1.0f);
  return lamp.power * cosine * fading(lamp, distance) * spot_factor(lamp, to_lamp) / (distance * distance);
}

LampAim aim(const Lamp& lamp, const Vec3& p, const Vec2& u) {
  const LightSample sample = sample_lamp(lamp, p, u);
  return {sample.direction, sample.distance, sample.radiance_over_density};
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
