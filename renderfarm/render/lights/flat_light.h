// SPDX-License-Identifier: Apache-2.0
/// Rectangles and disks that emit uniformly over their area and over all directions, on one side.
#pragma once

#include "renderfarm/render/lights/light_sample.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::render {

/// A light in the render frame; `across`, `up` and `normal` are perpendicular unit vectors.
struct FlatLight {
  bool is_disk = false;
  bool visible = true;  ///< Rays can hit the light.
  Vec3 centre = Vec3::Zero();
  Vec3 across = Vec3::UnitX();
  Vec3 up = Vec3::UnitZ();
  Vec3 normal = -Vec3::UnitY();  ///< On the emitting side.
  Vec2 half = Vec2::Zero();      ///< Half the width and half the height; for a disk, both are the radius.
  Vec3 radiance = Vec3::Zero();
  std::size_t group = 0;  ///< See scene/lamp_groups.h.

  [[nodiscard]] float area() const { return half.prod() * (is_disk ? kPi : 4.0f); }
};

/// Returns the light in the render frame, whose origin is `origin`. Precondition: `light` is a rectangle or disk.
[[nodiscard]] FlatLight make_flat_light(const scene::Light& light, const Eigen::Vector3d& origin);
/// Returns true if the light has finite parameters and emits light. A light without area emits none.
[[nodiscard]] bool is_lit(const FlatLight& light);

/// Samples a position. Returns false if `u` leads to no light: if `p` is behind the light or in its plane, or if the
/// position is beside a disk that is sampled by its bounding square. Near lights are sampled uniformly in solid angle,
/// far ones by area. Sources: Ureña, Fajardo, King, "An Area-Preserving Parametrization for Spherical Rectangles",
/// 2013; disks: Gamito, "Solid Angle Sampling of Disk and Cylinder Lights", 2016.
[[nodiscard]] bool sample_flat(const FlatLight& light, const Vec3& p, const Vec2& u, LightSample* ret_sample);
/// Returns the pdf of sample_flat() for a ray from `p` that hit the light after `distance`.
[[nodiscard]] float flat_pdf(const FlatLight& light, const Vec3& p, const Vec3& direction, float distance);

}  // namespace cyclorama::render
