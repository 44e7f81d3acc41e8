// SPDX-License-Identifier: Apache-2.0
/// FLIP: the difference that a person perceives when flipping between two pictures. Source: Andersson, Nilsson,
/// Akenine-Möller, Oskarsson, Åström and Fairchild, "FLIP: A Difference Evaluator for Alternating Images", HPG 2020,
/// with its errata; pooled by the mean, as its authors have recommended since. Reentrant.
#pragma once

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama::quality {

/// A display 0.7 m wide with 3840 pixels, seen from 0.7 m, as in the paper.
inline constexpr double kFlipPixelsPerDegree = 67.0206;

struct Flip {
  double mean = 0.0;     ///< 0 for equal pictures, at most 1.
  Image<float, 1> each;  ///< Per pixel.
};

/// Compares code values in 8-bit sRGB; symmetric in its pictures. Errors: those of check_same_size(); kInvalidArgument
/// unless `pixels_per_degree` is 1 to 1000.
Result<Flip> flip(const RgbImage& picture, const RgbImage& reference, double pixels_per_degree = kFlipPixelsPerDegree);

}  // namespace cyclorama::quality
