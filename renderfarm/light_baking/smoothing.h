// SPDX-License-Identifier: Apache-2.0
/// Takes noise from gathered light at the vertices of a mesh, by means over neighbours on the surface.
///
/// Light from other surfaces varies slowly, so neighbours are much alike. The part of a sample's difference
/// from its neighbourhood that its standard error does not explain is signal and stays (Wiener's filter). Differences
/// are pooled over the neighbourhood, because a single one is mostly noise. Source: Kavan, Bargteil and Sloan, "Least
/// Squares Vertex Baking", 2011, for smoothness along surfaces; Lee, "Digital Image Enhancement and Noise Filtering by Use of Local
/// Statistics", 1980, for the share that stays.
#pragma once

#include "renderfarm/light_baking/base_side.h"

namespace cyclorama::light_baking {

/// Smooths the gathered light of the seen samples of a side with a sample per vertex, and lowers its errors accordingly.
/// Neighbours whose normals differ much count less. Reentrant.
void smooth_gathered_light(const render::SurfaceMesh& mesh, BaseSide* side);

}  // namespace cyclorama::light_baking
