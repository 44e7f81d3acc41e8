// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/image/image.h"
#include "renderfarm/render/film.h"

namespace cyclorama::node {

/// Returns the weighted mean of a film's samples and `prior`, an earlier estimate of the same pixels that counts as
/// `weight` samples. The error is smallest if `weight` is one sample's squared error over that of `prior`. Without a
/// prior, or with a weight of 0, the result is exactly the film's own mean. Precondition: `prior` is empty or has the
/// film's size. Reentrant.
[[nodiscard]] RadianceImage mean_with_prior(const render::Film& film, const RadianceImage& prior, float weight);

}  // namespace cyclorama::node
