// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/denoise/guide.h"

namespace cyclorama {

/// One level of the edge-avoiding à-trous wavelet filter: each pixel becomes the mean of the nine at `step` pixels from
/// each other about it, weighted by how much they look like the same light on the same surface. Variances follow the
/// weights. Sources: Dammertz et al., "Edge-Avoiding À-Trous Wavelet Transform for fast Global Illumination Filtering",
/// HPG 2010; Schied et al., "Spatiotemporal Variance-Guided Filtering", HPG 2017. `scratch` and
/// `ret` are reshaped. Reentrant.
void filter_level(const Guide& guide, const LightPlanes& light, int step, Plane* scratch, LightPlanes* ret);

}  // namespace cyclorama
