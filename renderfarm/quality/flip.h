// SPDX-License-Identifier: Apache-2.0
/// FLIP: the difference that a person perceives when flipping between two pictures. Source: Andersson, Nilsson,
/// Akenine-Möller, Oskarsson, Åström and Fairchild, "FLIP: A Difference Evaluator for Alternating Images", HPG 2020,
/// with its errata. Pooled by the mean, as the authors have recommended since. Reentrant.
#pragma once

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama::quality {

/// Resolution of a display 0.7 m wide with 3840 pixels, seen from 0.7 m, as in the paper.
inline constexpr double kFlipPixelsPerDegree = 67.0206;

struct Flip {
  double mean = 0.0;     ///< 0 for equal pictures, at most 1.
  Image<float, 1> each;  ///< Value of each pixel.
};

/// Compares pictures in 8-bit sRGB; the result is symmetric. Errors: those of check_same_size(); kInvalidArgument
/// unless `pixels_per_degree` is in [1, 1000].
Result<Flip> flip(const RgbImage& picture, const RgbImage& reference, double pixels_per_degree = kFlipPixelsPerDegree);

}  // namespace cyclorama::quality
