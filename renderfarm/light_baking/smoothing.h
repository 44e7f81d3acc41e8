// SPDX-License-Identifier: Apache-2.0
/// Takes noise from gathered light, at the vertices of a mesh or on a grid, by means over neighbours on the surface.
///
/// Light from other surfaces varies slowly, so neighbouring samples are similar. The part of a sample's difference from
/// its neighbourhood that its standard error does not explain is signal and is kept (Wiener filter). The differences
/// are pooled over the neighbourhood, because a single one is mostly noise. Sources: Kavan, Bargteil and Sloan, "Least
/// Squares Vertex Baking", 2011, for smoothness along surfaces; Lee, "Digital Image Enhancement and Noise Filtering by
/// Use of Local Statistics", 1980, for the share that is kept.
#pragma once

#include "renderfarm/light_baking/base_side.h"

namespace cyclorama::light_baking {

/// Two samples that are neighbours on a surface.
struct Neighbours {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  float weight = 1.0f;  ///< Below 1 where they may differ.
};

/// Smooths the light of samples that have neighbours, and lowers its errors accordingly. Reentrant.
void smooth(std::span<const Neighbours> pairs, std::span<GatheredLight> light);

/// Smooths the gathered light of the seen samples of a side with a sample per vertex, and lowers its errors
/// accordingly. Neighbours whose normals differ much count less. Reentrant.
void smooth_gathered_light(const render::SurfaceMesh& mesh, BaseSide* side);

}  // namespace cyclorama::light_baking
