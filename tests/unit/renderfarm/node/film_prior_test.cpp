// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/film_prior.h"

#include <gtest/gtest.h>

namespace cyclorama::node {
namespace {

render::Film film_of(int samples, float each) {
  render::Film film(2, 1, false);
  for (int x = 0; x < 2; ++x) {
    *film.samples.at(x, 0) = samples;
    for (int c = 0; c < 3; ++c) film.sum.at(x, 0)[c] = static_cast<float>(samples) * each;
  }
  return film;
}

TEST(FilmPrior, counts_as_so_many_samples) {
  const RadianceImage mean = mean_with_prior(film_of(1, 5.0f), RadianceImage(2, 1, 1.0f), 3.0f);
  for (const float value : mean.data()) EXPECT_FLOAT_EQ(value, 2.0f);
}

TEST(FilmPrior, without_weight_or_picture_changes_no_bit) {
  const render::Film film = film_of(3, 0.1f);
  EXPECT_EQ(mean_with_prior(film, RadianceImage(2, 1, 1.0f), 0.0f), film.mean());
  EXPECT_EQ(mean_with_prior(film, RadianceImage(), 5.0f), film.mean());
}

TEST(FilmPrior, is_all_there_is_where_no_sample_was_taken) {
  const RadianceImage mean = mean_with_prior(film_of(0, 0.0f), RadianceImage(2, 1, 0.5f), 1e9f);
  for (const float value : mean.data()) EXPECT_FLOAT_EQ(value, 0.5f);
}

}  // namespace
}  // namespace cyclorama::node
