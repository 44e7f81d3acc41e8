// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/image/image.h"
#include "renderfarm/render/film.h"

namespace cyclorama::node {

/// Returns the mean of a film's samples and of `prior`, an earlier estimate of the same pixels, which counts as `weight`
/// samples: with the ratio of one sample's squared error to the estimate's, the mean that errs least. Without a prior, or
/// with a weight of 0, exactly the film's own mean. Precondition: `prior` is empty or has the film's size. Reentrant.
[[nodiscard]] RadianceImage mean_with_prior(const render::Film& film, const RadianceImage& prior, float weight);

}  // namespace cyclorama::node
