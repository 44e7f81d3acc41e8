// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/lights/light_bounds.h"

#include <cmath>

namespace cyclorama::render {

void DirectionCone::extend(const DirectionCone& other) {
  if (other.empty()) return;
  if (empty()) {
    *this = other;
    return;
  }
  constexpr float kRounding = 1e-6f;  // Radians that keep enclosed directions enclosed.
  const DirectionCone& wide = cosine <= other.cosine ? *this : other;
  const DirectionCone& narrow = cosine <= other.cosine ? other : *this;
  if (wide.axis == narrow.axis) {
    *this = wide;
    return;
  }
  const auto angle_of = [](float c) { return std::acos(std::clamp(c, -1.0f, 1.0f)); };
  const float half_wide = angle_of(wide.cosine);
  const float half_narrow = angle_of(narrow.cosine);
  // The chord is precise for small angles, unlike the cosine.
  const float between = 2.0f * std::asin(std::min(1.0f, 0.5f * (wide.axis - narrow.axis).norm()));
  if (between + half_narrow <= half_wide) {
    *this = wide;
    return;
  }
  const float half = 0.5f * (half_wide + between + half_narrow) + kRounding;
  const Vec3 aside = normalized_or(narrow.axis - wide.axis * wide.axis.dot(narrow.axis), Vec3::Zero());
  if (half >= kPi || aside.isZero(0.0f)) {
    *this = {wide.axis, -1.0f};
    return;
  }
  const float turn = half - half_wide;
  *this = {(wide.axis * std::cos(turn) + aside * std::sin(turn)).normalized(), std::cos(half)};
}

void LightBounds::extend(const LightBounds& other) {
  if (!(other.power > 0.0f)) return;
  const bool was_empty = !(power > 0.0f);
  low = low.cwiseMin(other.low);
  high = high.cwiseMax(other.high);
  normals.extend(other.normals);
  cos_emission = was_empty ? other.cos_emission : std::min(cos_emission, other.cos_emission);
  power += other.power;
  inverse_range = was_empty ? other.inverse_range : std::min(inverse_range, other.inverse_range);
}

}  // namespace cyclorama::render
