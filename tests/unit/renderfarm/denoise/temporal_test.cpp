// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/denoise/temporal.h"

#include <gtest/gtest.h>

#include "tests/doubles/analytic_film.h"

namespace cyclorama {
namespace {

constexpr int kMostSamples = 16;

FilmView view_of(const AnalyticScene& scene) {
  return {scene.eye, scene.heading_rad, scene.panorama, {0, 0, scene.panorama.width_px, scene.panorama.height_px}};
}

AnalyticScene small_scene() {
  AnalyticScene scene;
  scene.panorama = {96, 48, 1.2, 0.3, -0.3};
  scene.firefly_every = 0.0;
  return scene;
}

double squared_error(const RadianceImage& image, const RadianceImage& truth) {
  double sum = 0.0;
  for (std::size_t i = 0; i < image.data().size(); ++i) {
    const double difference = static_cast<double>(image.data()[i]) - static_cast<double>(truth.data()[i]);
    sum += difference * difference;
  }
  return sum / static_cast<double>(image.data().size());
}

TEST(TemporalHistory, while_nothing_moves_it_is_the_average_of_all_samples) {
  const AnalyticScene scene = small_scene();
  TemporalHistory history(kMostSamples);
  const RadianceImage truth = scene.truth();
  double first = 0.0;
  Film film;
  for (std::uint64_t i = 0; i < 32; ++i) {
    film = history.accumulate(scene.film(1, i), view_of(scene));
    if (i == 0) first = squared_error(film.mean(), truth);
  }
  EXPECT_EQ(*film.samples.at(48, 40), 32);
  EXPECT_NEAR(squared_error(film.mean(), truth), first / 32.0, 0.25 * first / 32.0);
}

TEST(TemporalHistory, a_turn_by_whole_pixels_is_an_exact_shift) {
  AnalyticScene scene = small_scene();
  TemporalHistory history(kMostSamples);
  const Film before = history.accumulate(scene.film(1, 1), view_of(scene));
  scene.heading_rad += 7 * scene.panorama.radians_per_px();
  const Film now = scene.film(1, 2);
  const Film both = history.accumulate(now, view_of(scene));
  for (int y = 0; y < both.height(); ++y) {
    for (int x = 0; x < both.width() - 7; ++x) {
      ASSERT_EQ(*both.sum.at(x, y), *now.sum.at(x, y) + *before.sum.at(x + 7, y)) << x << ", " << y;
      ASSERT_EQ(*both.samples.at(x, y), 2) << x << ", " << y;
    }
    ASSERT_EQ(*both.samples.at(both.width() - 7, y), 1);
  }
}

TEST(TemporalHistory, a_step_aside_carries_what_is_still_seen_and_leaves_out_what_was_hidden) {
  AnalyticScene scene = small_scene();
  scene.noise = 0.0;
  TemporalHistory history(kMostSamples);
  (void)history.accumulate(scene.film(4, 1), view_of(scene));
  scene.eye.x() += 0.3;
  const Film now = scene.film(4, 2);
  const Film both = history.accumulate(now, view_of(scene));
  const RadianceImage truth = scene.truth();
  int carried = 0;
  for (const std::int32_t samples : both.samples.data()) carried += samples > 4 ? 1 : 0;
  EXPECT_GT(carried, both.width() * both.height() / 2);
  EXPECT_LT(carried, both.width() * both.height());
  EXPECT_LT(squared_error(both.mean(), truth), 1.2 * squared_error(now.mean(), truth));
}

TEST(TemporalHistory, noise_falls_while_the_eye_walks) {
  AnalyticScene scene = small_scene();
  TemporalHistory history(kMostSamples);
  Film film;
  for (std::uint64_t i = 0; i < 12; ++i) {
    scene.eye.x() += 0.01;
    film = history.accumulate(scene.film(1, i), view_of(scene));
  }
  const RadianceImage truth = scene.truth();
  EXPECT_LT(squared_error(film.mean(), truth), 0.5 * squared_error(scene.film(1, 99).mean(), truth));
}

TEST(TemporalHistory, another_normal_or_distance_is_another_surface) {
  for (const bool by_normal : {true, false}) {
    AnalyticScene scene = small_scene();
    TemporalHistory history(kMostSamples);
    Film other = scene.film(1, 1);
    for (float& value : by_normal ? other.features.normal.data() : other.features.distance.data()) {
      value *= by_normal ? -1.0f : 1.5f;
    }
    (void)history.accumulate(other, view_of(scene));
    scene.eye.x() += 1e-3;
    const Film film = history.accumulate(scene.film(1, 2), view_of(scene));
    EXPECT_EQ(*film.samples.at(48, 40), 1);
  }
}

TEST(TemporalHistory, forgets_when_told_to) {
  const AnalyticScene scene = small_scene();
  TemporalHistory history(kMostSamples);
  (void)history.accumulate(scene.film(1, 1), view_of(scene));
  history.clear();
  EXPECT_EQ(*history.accumulate(scene.film(1, 2), view_of(scene)).samples.at(48, 40), 1);
}

}  // namespace
}  // namespace cyclorama
