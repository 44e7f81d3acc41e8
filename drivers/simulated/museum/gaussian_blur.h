// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace cyclorama::simulated {

/// Blurs a plane of floats in place, rows of `width`, with a normalised Gaussian cut off at four standard deviations.
/// The plane's border values are continued outside. Does nothing for a sigma of 0.
void blur_plane(std::vector<float>* plane, int width, int height, double sigma_px, int threads);

}  // namespace cyclorama::simulated
