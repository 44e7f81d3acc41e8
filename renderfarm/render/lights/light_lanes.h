// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/render/lights/light_bounds.h"

namespace cyclorama::render {

/// Four lights that are evaluated together: estimates of what each contributes at one point. A value.
class LightLanes {
 public:
  using Four = Eigen::Array4f;

  LightLanes();  ///< Creates four lights that emit nothing.
  /// Sets one light; `lane` is in [0, 4).
  void set(std::size_t lane, const LightBounds& light);
  /// Returns an approximate upper bound of each light's irradiance (luminance); zero only where it cannot shine. A zero
  /// `n` is a surface lit from both sides.
  [[nodiscard]] Four estimate(const Vec3& p, const Vec3& n) const;

 private:
  Four x_, y_, z_, radius_;        ///< Bounding sphere of the light.
  Four axis_x_, axis_y_, axis_z_;  ///< Zero if the light emits in all directions.
  Four cos_edge_;                  ///< Cosine of the greatest emission angle; -1 for all directions.
  Four slope_;                     ///< 1 / (1 - cos_edge)
  Four power_;
  Four inverse_range_;
};

inline LightLanes::Four LightLanes::estimate(const Vec3& p, const Vec3& n) const {
  constexpr float kMinDistance2 = 1e-6f;  // Lower bound that keeps the estimate finite near point lights.
  const Four dx = x_ - p.x();
  const Four dy = y_ - p.y();
  const Four dz = z_ - p.z();
  const Four distance2 = dx * dx + dy * dy + dz * dz;
  const Four least2 = (radius_ * radius_).max(kMinDistance2);
  const Four distance = distance2.max(1e-30f).sqrt();
  const Four inverse = 1.0f / distance;
  // The light lies within an angle b of the direction to its centre; cos(a - b) is at most cos a + sin b.
  const Four sin_b = radius_ * inverse;
  const float both_sides = n.isZero(0.0f) ? 1.0f : 0.0f;
  const Four cosine = (dx * n.x() + dy * n.y() + dz * n.z()) * inverse;
  const Four received = (cosine + sin_b + both_sides).max(0.0f).min(1.0f);
  const Four towards = (dx * axis_x_ + dy * axis_y_ + dz * axis_z_) * -inverse;
  const Four emitted = ((towards + sin_b - cos_edge_) * slope_).max(0.0f).min(1.0f);
  const Four part = (distance - radius_).max(0.0f) * inverse_range_;
  const Four part2 = part * part;
  const Four fade = (1.0f - part2 * part2).max(0.0f);
  return power_ * received * emitted * fade / distance2.max(least2);
}

}  // namespace cyclorama::render
