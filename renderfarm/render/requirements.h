// SPDX-License-Identifier: Apache-2.0
/// The needs of materials from the ray kernels, of which there is one for each surface level. Cut-outs and
/// half-transparent surfaces need nothing, because Embree calls a filter for them (alpha_filter.h).
#pragma once

#include <string_view>
#include <vector>

#include "renderfarm/render/surface_level.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::render {

/// Returns the highest level of any material that is used: one without triangles needs nothing. Reentrant.
[[nodiscard]] SurfaceLevel highest_surface_level(const scene::Scene& scene);

/// Returns "matte surfaces", "glossy surfaces" or "layered surfaces".
[[nodiscard]] std::string_view describe(SurfaceLevel level);

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
