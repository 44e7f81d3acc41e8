// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/denoise/guide.h"

namespace cyclorama::denoise {

/// Applies one level of the edge-avoiding à-trous wavelet filter: each pixel becomes the mean of nine pixels spaced
/// `step` apart around it, weighted by the similarity of their light and surface. Variances are propagated with the
/// weights. Sources: Dammertz et al., "Edge-Avoiding À-Trous Wavelet Transform for fast Global Illumination Filtering",
/// HPG 2010; Schied et al., "Spatiotemporal Variance-Guided Filtering", HPG 2017. `scratch` and `ret` are reshaped.
/// Reentrant.
void filter_level(const Guide& guide, const LightPlanes& light, int step, Plane* scratch, LightPlanes* ret);

}  // namespace cyclorama::denoise
