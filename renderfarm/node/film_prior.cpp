// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/film_prior.h"

#include "common/base/check.h"

namespace cyclorama::node {

RadianceImage mean_with_prior(const render::Film& film, const RadianceImage& prior, float weight) {
  RadianceImage mean = film.mean();
  if (prior.empty() || !(weight > 0.0f)) return mean;
  CHECK(prior.width() == film.width() && prior.height() == film.height());
  for (std::size_t pixel = 0; pixel < film.samples.data().size(); ++pixel) {
    const float share = weight / (weight + static_cast<float>(film.samples.data()[pixel]));
    for (std::size_t c = 3 * pixel; c < 3 * pixel + 3; ++c) {
      mean.data()[c] += share * (prior.data()[c] - mean.data()[c]);
    }
  }
  return mean;
}

}  // namespace cyclorama::node
