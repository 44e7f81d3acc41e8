// SPDX-License-Identifier: Apache-2.0
/// A reference in two halves that were rendered with independent random numbers. The mean product of a picture's errors
/// against the two halves does not contain the reference's noise. Reentrant.
#pragma once

#include "common/image/image.h"

namespace cyclorama::quality {

struct SplitReference {
  RadianceImage a;
  RadianceImage b;
};

/// Returns the mean of both halves. They must have the same size, as must all pictures below.
[[nodiscard]] RadianceImage mean_of(const SplitReference& reference);

/// Returns the relMSE without the reference's noise: the mean of (p - a)(p - b) / (r^2 + 0.01), with r = (a + b) / 2.
/// It may be below zero by chance. The noise in r adds about 1.5 times the square of a half's relMSE.
[[nodiscard]] double unbiased_relmse(const RadianceImage& picture, const SplitReference& reference);

/// Returns the relMSE of one half, from its difference from the other half.
[[nodiscard]] double half_relmse(const SplitReference& reference);

/// Returns the mean of all values. Precondition: the picture is not empty.
[[nodiscard]] double mean_value(const RadianceImage& picture);

/// Returns the means of blocks of `side` x `side` pixels. Pixels beyond the last whole block are ignored.
[[nodiscard]] RadianceImage block_means(const RadianceImage& picture, int side);
[[nodiscard]] SplitReference block_means(const SplitReference& reference, int side);

}  // namespace cyclorama::quality
