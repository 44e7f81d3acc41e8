// SPDX-License-Identifier: Apache-2.0
/// The scattering of light at surfaces: glTF 2.0's model (appendix B) with specular, ior, clearcoat, transmission and
/// volume. There are three levels, each with a separate kernel; a scene is rendered with the lowest level that it
/// needs.
///
///     const Bsdf bsdf = make_bsdf(material, texels, inside, kLevel);
///     const Scattering<kLevel> scattering(bsdf, normal, wo);
#pragma once

#include "renderfarm/render/bsdf/glossy.h"
#include "renderfarm/render/bsdf/layered.h"
#include "renderfarm/render/bsdf/scattering.h"

namespace cyclorama::render {

/// Returns `normal`, bent just enough for the mirror direction to lie above the geometric surface, whose normal is
/// `facing`. Without this, smooth normals on coarse meshes reflect the inside, which shows as black rings. All vectors
/// have unit length; `wo` and `normal` are on the side of `facing`. Source: Keller et al., "The Iray Light Transport
/// Simulation and Rendering System", 2017.
[[nodiscard]] inline Vec3 reflecting_normal(const Vec3& normal, const Vec3& facing, const Vec3& wo) {
  const Vec3 mirrored = 2.0f * normal.dot(wo) * normal - wo;
  const float wanted = std::min(0.05f, facing.dot(wo));
  const float above = facing.dot(mirrored);
  if (above >= wanted) return normal;
  const Vec3 lifted = normalized_or(mirrored + facing * (wanted - above), facing);
  return normalized_or(wo + lifted, facing);
}

}  // namespace cyclorama::render
