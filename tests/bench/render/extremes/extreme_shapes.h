// SPDX-License-Identifier: Apache-2.0
/// Building blocks of extreme scenes. Metres, y up.
#pragma once

#include "renderfarm/render/renderer.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama {

/// A test material: matte and grey by default.
[[nodiscard]] scene::Material plain_material(const Eigen::Vector3f& albedo = Eigen::Vector3f::Constant(0.5f));

/// A closed sphere about the origin, with `rings` from pole to pole and optional smooth normals.
[[nodiscard]] scene::Mesh ball(double radius, int rings, bool smooth);
/// A closed box about the origin, visible from inside and outside, since surfaces are two-sided.
[[nodiscard]] scene::Mesh block(const Eigen::Vector3d& size);
/// A square in the plane y = 0 about the origin, with texture coordinates from 0 to `repeats`.
[[nodiscard]] scene::Mesh square(double size, float repeats = 1.0f);

/// Adds the mesh and its material, and updates the bounds.
void put(scene::Scene& scene, scene::Mesh mesh, const scene::Material& material,
         const Eigen::Affine3d& T_scene_mesh = Eigen::Affine3d::Identity());

[[nodiscard]] scene::Light lamp_at(const Eigen::Vector3d& position, float candela, double radius_m);
/// Visible; shines along `direction`.
[[nodiscard]] scene::Light panel_at(const Eigen::Vector3d& position, const Eigen::Vector3d& direction, double size_m,
                                    float radiance);
/// The same radiance from all directions.
[[nodiscard]] scene::Sky even_sky(float radiance);

/// Grey floor, a ball on it, an even sky: no pixel is black.
[[nodiscard]] scene::Scene open_ground();
/// A full panorama from `eye`, 64 x 32 pixels, 8 samples of up to 4 bounces.
[[nodiscard]] render::PanoramaView view_around(const Eigen::Vector3d& eye);

}  // namespace cyclorama
