// SPDX-License-Identifier: Apache-2.0
/// The features that a scene needs from the ray kernels, which select a kernel compiled without the rest. Cut-outs and
/// half-transparent surfaces need nothing, because Embree calls a filter for them (alpha_filter.h).
#pragma once

#include <string>
#include <vector>

#include "renderfarm/render/surface_level.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::render {

struct SceneNeeds {
  bool textures = false;
  bool normal_maps = false;                     ///< Only together with textures.
  SurfaceLevel surface = SurfaceLevel::kMatte;  ///< The highest level of any material.
  bool lights = false;                          ///< Lights that are sampled.
  bool environment = false;                     ///< Light of rays that hit nothing.

  friend bool operator==(const SceneNeeds&, const SceneNeeds&) = default;
};

/// Derives the needs from what is used: a material without triangles needs nothing. Reentrant.
[[nodiscard]] SceneNeeds needs_of(const scene::Scene& scene);

/// Returns the union of both.
[[nodiscard]] SceneNeeds operator|(const SceneNeeds& a, const SceneNeeds& b);

/// Returns what the kernel selected for `needs` is compiled for. It may be more than `needs`, because not every
/// combination exists.
[[nodiscard]] SceneNeeds kernel_for(const SceneNeeds& needs);

/// Formats needs such as "textures, glossy surfaces, lights"; "nothing" if there are none.
[[nodiscard]] std::string describe(const SceneNeeds& needs);

/// Returns the lowest level that renders the material correctly, given what its factors reach through their textures.
/// A dielectric of roughness 1, which scans without a material have, is purely Lambertian. `textures` are the model's;
/// reads texels until one decides, which is often the first.
[[nodiscard]] SurfaceLevel surface_level_of(const scene::Material& material,
                                            const std::vector<scene::Texture>& textures);
/// Returns for each texture whether it has texels that are not opaque; checked only if a material blends by it.
[[nodiscard]] std::vector<bool> see_through_textures(const scene::Model& model);
/// Returns true if any of `mesh` is transparent: many files specify AlphaMode::kBlend with only opaque texels.
[[nodiscard]] bool blends(const scene::Material& material, const scene::Mesh& mesh,
                          const std::vector<bool>& see_through);

}  // namespace cyclorama::render
