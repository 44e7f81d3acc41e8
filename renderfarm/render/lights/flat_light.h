// SPDX-License-Identifier: Apache-2.0
/// Rectangles and disks that shine alike from every place and in every direction, on one side.
#pragma once

#include "renderfarm/render/lights/light_sample.h"
#include "renderfarm/scene/model.h"

namespace cyclorama {

/// In the render frame; `across`, `up` and `normal` are of unit length and square to each other.
struct FlatLight {
  bool is_disk = false;
  bool visible = true;  ///< Rays meet it.
  Vec3 centre = Vec3::Zero();
  Vec3 across = Vec3::UnitX();
  Vec3 up = Vec3::UnitZ();
  Vec3 normal = -Vec3::UnitY();  ///< Of the side that shines.
  Vec2 half = Vec2::Zero();      ///< Of width and height; of a disk the radius, twice.
  Vec3 radiance = Vec3::Zero();

  [[nodiscard]] float area() const { return half.prod() * (is_disk ? kPi : 4.0f); }
};

/// `light` is a rectangle or disk; rebased to `origin`.
[[nodiscard]] FlatLight make_flat_light(const Light& light, const Eigen::Vector3d& origin);
/// Whether it gives any light, and that in numbers. One without an area does not.
[[nodiscard]] bool is_lit(const FlatLight& light);

/// False where `u` gives no light: behind it, on it, or beside a disk that is sampled with the square around it.
/// Near rectangles are sampled uniformly in solid angle, far ones by area. Sources: Ureña, Fajardo, King, "An
/// Area-Preserving Parametrization for Spherical Rectangles", 2013; disks: Gamito, "Solid Angle Sampling of Disk and
/// Cylinder Lights", 2016.
[[nodiscard]] bool sample_flat(const FlatLight& light, const Vec3& p, const Vec2& u, LightSample* ret_sample);
/// That of sample_flat() for a ray from `p` that met the light after `distance`.
[[nodiscard]] float flat_density(const FlatLight& light, const Vec3& p, const Vec3& direction, float distance);

}  // namespace cyclorama
