// SPDX-License-Identifier: Apache-2.0
/// A reference of which two halves were rendered with independent random numbers: the product of a picture's errors
/// against both has no share of the reference's noise. Reentrant.
#pragma once

#include "common/image/image.h"

namespace cyclorama::quality {

struct SplitReference {
  RadianceImage a;
  RadianceImage b;
};

/// Returns the mean of both halves. They must have one size, like all pictures below.
[[nodiscard]] RadianceImage mean_of(const SplitReference& reference);

/// relMSE without the reference's noise: the mean of (p - a)(p - b) / (r^2 + 0.01), with r = (a + b) / 2. May be below
/// zero by chance. The noise in r adds some 1.5 times the square of a half's relMSE.
[[nodiscard]] double unbiased_relmse(const RadianceImage& picture, const SplitReference& reference);

/// Returns the relMSE of one half, from its difference to the other.
[[nodiscard]] double half_relmse(const SplitReference& reference);

/// Returns the mean of all values of a picture that is not empty.
[[nodiscard]] double mean_value(const RadianceImage& picture);

/// Returns the means of blocks of `side` x `side` pixels. Pixels beyond the last whole block are left out.
[[nodiscard]] RadianceImage block_means(const RadianceImage& picture, int side);
[[nodiscard]] SplitReference block_means(const SplitReference& reference, int side);

}  // namespace cyclorama::quality
