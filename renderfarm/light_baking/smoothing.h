// SPDX-License-Identifier: Apache-2.0
/// Reduces the noise of gathered light at the vertices of a mesh by means over neighbours on the surface.
///
/// Light from other surfaces varies slowly, so neighbouring samples are similar. The part of a sample's difference from
/// its neighbourhood that its standard error does not explain is signal and is kept (Wiener filter). The differences
/// are pooled over the neighbourhood, because a single one is mostly noise. Sources: Kavan, Bargteil and Sloan, "Least
/// Squares Vertex Baking", 2011, for smoothness along surfaces; Lee, "Digital Image Enhancement and Noise Filtering by
/// Use of Local Statistics", 1980, for the share that is kept.
#pragma once

#include "renderfarm/light_baking/base_side.h"

namespace cyclorama::light_baking {

/// Smooths the gathered light of a side's seen samples, and reduces their errors accordingly. Does nothing if the side
/// has samples per triangle. Neighbours whose normals differ much count less. Reentrant.
void smooth_gathered_light(const render::SurfaceMesh& mesh, BaseSide* side);

}  // namespace cyclorama::light_baking
