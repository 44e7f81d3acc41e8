// SPDX-License-Identifier: Apache-2.0
/// What a scene needs from the ray kernels, so that one is picked that is compiled without the rest. Cut-outs and
/// half-transparent surfaces need nothing: where they are, Embree asks (alpha_filter.h).
#pragma once

#include <string>
#include <vector>

#include "renderfarm/render/surface_level.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama {

struct SceneNeeds {
  bool textures = false;
  bool normal_maps = false;                     ///< Only with textures.
  SurfaceLevel surface = SurfaceLevel::kMatte;  ///< The highest of any material.
  bool lights = false;                          ///< Anything that is aimed at.
  bool environment = false;                     ///< Light from where no triangle is.

  friend bool operator==(const SceneNeeds&, const SceneNeeds&) = default;
};

/// Found from what is used: a material that no triangle has needs nothing. Looks at the alpha of every texel.
/// Reentrant.
[[nodiscard]] SceneNeeds needs_of(const Scene& scene);

/// Both together.
[[nodiscard]] SceneNeeds operator|(const SceneNeeds& a, const SceneNeeds& b);

/// What the kernel that is picked for `needs` is compiled for: not every combination exists, so it may be more.
[[nodiscard]] SceneNeeds kernel_for(const SceneNeeds& needs);

/// "textures, glossy surfaces, lights"; "nothing" for the least.
[[nodiscard]] std::string describe(const SceneNeeds& needs);

// What one material needs.

/// The least that shows it, whatever its textures hold. A dielectric of roughness 1, as scans without a material have
/// it, is pure Lambert.
[[nodiscard]] SurfaceLevel surface_level_of(const Material& material);
/// For each texture, whether it has texels that are not opaque; looked at only where a material blends by it.
[[nodiscard]] std::vector<bool> see_through_textures(const Model& model);
/// Whether light goes through any of `mesh`: many a file says AlphaMode::kBlend and has nothing but opaque texels.
[[nodiscard]] bool blends(const Material& material, const Mesh& mesh, const std::vector<bool>& see_through);

}  // namespace cyclorama
