// SPDX-License-Identifier: Apache-2.0
/// Requirements of materials on the ray kernels; there is one kernel for each surface level. Cut-outs and
/// half-transparent surfaces need nothing, because Embree calls a filter for them (alpha_filter.h).
#pragma once

#include <string_view>
#include <vector>

#include "renderfarm/render/surface_level.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::render {

/// Returns the highest level of the materials of all meshes that have triangles and an instance. Reentrant.
[[nodiscard]] SurfaceLevel highest_surface_level(const scene::Scene& scene);

/// Returns "matte surfaces", "glossy surfaces" or "layered surfaces".
[[nodiscard]] std::string_view describe(SurfaceLevel level);

/// Returns the lowest level that renders the material correctly, given the range of its factors after multiplication by
/// their textures. A dielectric of roughness 1, as in scans without a material, is purely Lambertian. `textures` are
/// the model's; texels are read until one decides, which is often the first.
[[nodiscard]] SurfaceLevel surface_level_of(const scene::Material& material,
                                            const std::vector<scene::Texture>& textures);
/// Returns, for each texture, true if a material uses it for blending and any of its texels is not opaque.
[[nodiscard]] std::vector<bool> see_through_textures(const scene::Model& model);
/// Returns true if any part of `mesh` is transparent; AlphaMode::kBlend alone does not decide, because many files
/// specify it with only opaque texels.
[[nodiscard]] bool blends(const scene::Material& material, const scene::Mesh& mesh,
                          const std::vector<bool>& see_through);

}  // namespace cyclorama::render
