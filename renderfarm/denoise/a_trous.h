// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/denoise/guide.h"

namespace cyclorama::denoise {

/// Applies one level of the edge-avoiding à-trous wavelet filter. Each pixel becomes the mean of nine pixels around it,
/// `step` apart and weighted by the similarity of their light and surfaces. Variances are propagated with the weights.
/// `scratch` and `ret` are reshaped. Reentrant. Sources: Dammertz et al., "Edge-Avoiding À-Trous Wavelet Transform for
/// fast Global Illumination Filtering", HPG 2010; Schied et al., "Spatiotemporal Variance-Guided Filtering", HPG 2017.
void filter_level(const Guide& guide, const LightPlanes& light, int step, Plane* scratch, LightPlanes* ret);

}  // namespace cyclorama::denoise
