// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/denoise/denoise.h"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "tests/data_sets/analytic_film.h"

namespace cyclorama::denoise {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A grey wall five metres away that emits `light`, without noise yet.
struct Wall {
  render::Film film;
  PixelRays rays;

  Wall(int width, int height, int samples, float light = 1.0f) : film(width, height, true) {
    rays = panorama_rays({width, height, 1e-3 * width, 5e-4 * height, -5e-4 * height}, 0.0, {0, 0, width, height});
    std::fill(film.features.albedo.data().begin(), film.features.albedo.data().end(), 0.5f);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        film.features.normal.at(x, y)[2] = 1.0f;
        *film.features.distance.at(x, y) = 5.0f / -rays.directions.at(x, y)[2];
        set(x, y, samples, std::vector<float>(static_cast<std::size_t>(samples), light));
      }
    }
  }
  /// Sets the pixel's samples to grey light.
  void set(int x, int y, int samples, const std::vector<float>& lights) {
    *film.samples.at(x, y) = samples;
    *film.square.at(x, y) = std::inner_product(lights.begin(), lights.end(), lights.begin(), 0.0f);
    std::fill_n(film.sum.at(x, y), 3, std::accumulate(lights.begin(), lights.end(), 0.0f));
  }
  /// Adds samples with an exponential distribution around the mean `light(x, y)`.
  template <typename LightAt>
  void add_noise(int samples, std::uint32_t seed, const LightAt& light) {
    std::mt19937 generator(seed);
    std::exponential_distribution<float> exponential;
    std::vector<float> lights(static_cast<std::size_t>(samples));
    for (int y = 0; y < film.height(); ++y) {
      for (int x = 0; x < film.width(); ++x) {
        for (float& value : lights) value = light(x, y) * (0.5f + 0.5f * exponential(generator));
        set(x, y, samples, lights);
      }
    }
  }
  [[nodiscard]] RadianceImage denoised() const { return cyclorama::denoise::denoised(film, rays); }
};

double mean_of(const RadianceImage& image) {
  return std::accumulate(image.data().begin(), image.data().end(), 0.0) / static_cast<double>(image.data().size());
}

double squared_error(const RadianceImage& image, const RadianceImage& truth) {
  double sum = 0.0;
  for (std::size_t i = 0; i < image.data().size(); ++i) {
    const double difference = static_cast<double>(image.data()[i]) - static_cast<double>(truth.data()[i]);
    sum += difference * difference;
  }
  return sum / static_cast<double>(image.data().size());
}

bool is_finite(const RadianceImage& image) {
  return std::all_of(image.data().begin(), image.data().end(), [](float v) { return std::isfinite(v); });
}

TEST(Denoiser, removes_the_noise_of_an_even_wall_and_keeps_its_mean) {
  constexpr double kMaxLoss = 0.02;  // Caused by fireflies, and by the weight of the brightest pixels.
  for (const int samples : {1, 2, 4}) {
    Wall wall(96, 96, samples);
    wall.add_noise(samples, 5, [](int, int) { return 1.0f; });
    const RadianceImage truth(96, 96, 1.0f);
    const RadianceImage picture = wall.denoised();
    EXPECT_NEAR(mean_of(picture) / mean_of(wall.film.mean()), 1.0, kMaxLoss) << samples;
    EXPECT_LT(squared_error(picture, truth), 0.1 * squared_error(wall.film.mean(), truth)) << samples;
  }
}

/// Ten times as much light in the right half; the test sets the features there.
template <typename Change>
void expect_edge_kept(const Change& change) {
  Wall wall(64, 32, 4);
  wall.add_noise(4, 7, [](int x, int) { return x < 32 ? 1.0f : 10.0f; });
  for (int y = 0; y < 32; ++y) {
    for (int x = 32; x < 64; ++x) change(&wall.film.features, x, y);
  }
  const RadianceImage picture = wall.denoised();
  double left = 0.0;
  double right = 0.0;
  for (int y = 0; y < 32; ++y) {
    left += static_cast<double>(*picture.at(31, y)) / 32.0;
    right += static_cast<double>(*picture.at(32, y)) / 32.0;
  }
  EXPECT_NEAR(left, 1.0, 0.15);
  EXPECT_NEAR(right, 10.0, 1.5);
}

TEST(Denoiser, keeps_an_edge_of_albedo) {
  expect_edge_kept([](render::FilmFeatures* features, int x, int y) {
    std::fill_n(features->albedo.at(x, y), 3, 0.9f);
    std::fill_n(features->albedo.at(x - 32, y), 3, 0.09f);
  });
}

TEST(Denoiser, keeps_an_edge_of_the_normal) {
  expect_edge_kept([](render::FilmFeatures* features, int x, int y) {
    features->normal.at(x, y)[0] = 0.7071f;
    features->normal.at(x, y)[2] = 0.7071f;
  });
}

TEST(Denoiser, keeps_an_edge_of_depth) {
  expect_edge_kept([](render::FilmFeatures* features, int x, int y) { *features->distance.at(x, y) *= 1.05f; });
}

TEST(Denoiser, does_not_blur_a_firefly_into_a_spot) {
  for (const int samples : {1, 4}) {
    Wall wall(33, 33, samples);
    wall.add_noise(samples, 3, [](int, int) { return 1.0f; });
    std::vector<float> lights(static_cast<std::size_t>(samples), 1.0f);
    lights[0] = 10000.0f;
    wall.set(16, 16, samples, lights);
    const RadianceImage picture = wall.denoised();
    EXPECT_LT(*std::max_element(picture.data().begin(), picture.data().end()), 2.5f) << samples;
  }
}

TEST(Denoiser, keeps_a_small_highlight_that_its_samples_confirm) {
  Wall wall(33, 33, 4);
  wall.set(16, 16, 4, {99.0f, 100.0f, 100.0f, 101.0f});
  EXPECT_NEAR(*wall.denoised().at(16, 16), 100.0f, 1.0f);
}

TEST(Denoiser, does_not_change_a_picture_without_noise) {
  Wall wall(48, 48, 2);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 48; ++x)
      wall.set(x, y, 2, {1.0f + 0.1f * static_cast<float>(x % 5), 1.0f + 0.1f * static_cast<float>(x % 5)});
  }
  const RadianceImage mean = wall.film.mean();
  const RadianceImage picture = wall.denoised();
  for (std::size_t i = 0; i < mean.data().size(); ++i) ASSERT_NEAR(picture.data()[i], mean.data()[i], 2e-3f);
}

TEST(Denoiser, has_a_smaller_error_than_the_film_from_one_sample_to_a_thousand) {
  for (const bool stratified : {false, true}) {
    AnalyticScene scene;
    scene.panorama = {64, 32, 1.2, 0.3, -0.3};
    scene.stratified = stratified;
    scene.firefly_every = stratified ? 0.0 : 2000.0;
    const RadianceImage truth = scene.truth(32);
    for (const int samples : {1, 2, 4, 16, 64, 256, 1024}) {
      const render::Film film = scene.film(samples, 1);
      // With stratified samples the film's own variance is far too large; the filter must not undo the gain of
      // stratification.
      const double allowed = stratified && samples >= 16 ? 1.1 : 1.0;
      EXPECT_LE(squared_error(denoised(film, scene.rays()), truth), allowed * squared_error(film.mean(), truth))
          << samples << " samples, stratified: " << stratified;
    }
  }
}

TEST(Denoiser, a_block_with_its_margin_equals_that_part_of_the_picture_bit_by_bit) {
  AnalyticScene scene;
  const render::Film film = scene.film(2, 4);
  const RadianceImage whole = denoised(film, scene.rays());
  const int halo = Denoiser::halo_px();
  Denoiser denoiser;
  for (const PixelRect& block : {PixelRect{0, 0, 80, 48}, PixelRect{80, 0, 112, 48}, PixelRect{37, 21, 50, 33}}) {
    const int left = std::max(0, block.x - halo);
    const int top = std::max(0, block.y - halo);
    const PixelRect rect{left, top, std::min(film.width(), block.x + block.width + halo) - left,
                         std::min(film.height(), block.y + block.height + halo) - top};
    render::Film part(rect.width, rect.height, true);
    for (int y = 0; y < rect.height; ++y) {
      const auto copy = [&](const auto& from, auto* to) {
        std::copy_n(from.at(rect.x, rect.y + y), to->row_values(), to->at(0, y));
      };
      copy(film.sum, &part.sum);
      copy(film.square, &part.square);
      copy(film.samples, &part.samples);
      copy(film.features.albedo, &part.features.albedo);
      copy(film.features.normal, &part.features.normal);
      copy(film.features.distance, &part.features.distance);
    }
    RadianceImage picture(rect.width, rect.height);
    const PixelRect inside{block.x - rect.x, block.y - rect.y, block.width, block.height};
    denoiser.denoise(part, panorama_rays(scene.panorama, scene.heading_rad, rect), inside, &picture);
    for (int y = 0; y < block.height; ++y) {
      for (int x = 0; x < block.width; ++x) {
        for (int c = 0; c < 3; ++c) {
          ASSERT_EQ(picture.at(inside.x + x, inside.y + y)[c], whole.at(block.x + x, block.y + y)[c]) << x << ", " << y;
        }
      }
    }
  }
}

TEST(Denoiser, does_not_spread_nan) {
  for (const float bad : {kNan, kInfinity, -kInfinity, 3e38f, -3e38f, 1e-42f}) {
    for (int which = 0; which < 6; ++which) {
      Wall wall(24, 24, 2);
      wall.add_noise(2, 1, [](int, int) { return 1.0f; });
      render::FilmFeatures& features = wall.film.features;
      float* const places[] = {wall.film.sum.at(12, 12),     wall.film.square.at(12, 12),
                               features.albedo.at(12, 12),   features.normal.at(12, 12),
                               features.distance.at(12, 12), wall.rays.directions.at(12, 12)};
      *places[which] = bad;
      const RadianceImage picture = wall.denoised();
      EXPECT_TRUE(is_finite(picture)) << bad << " in " << which;
      EXPECT_NEAR(*picture.at(20, 20), 1.0f, 0.5f) << bad << " in " << which;
    }
  }
}

TEST(Denoiser, pixels_without_samples_are_black_and_do_not_affect_their_neighbours) {
  Wall wall(24, 24, 2);
  wall.set(12, 12, 0, {});
  const RadianceImage picture = wall.denoised();
  EXPECT_EQ(*picture.at(12, 12), 0.0f);
  EXPECT_NEAR(*picture.at(13, 12), 1.0f, 1e-5f);
  EXPECT_EQ(mean_of(Wall(5, 5, 0).denoised()), 0.0);
}

TEST(Denoiser, handles_ten_orders_of_magnitude_side_by_side) {
  Wall wall(48, 24, 2);
  wall.add_noise(2, 2, [](int x, int) { return x < 24 ? 1e10f : 1e-3f; });
  for (int y = 0; y < 24; ++y) {
    for (int x = 24; x < 48; ++x) wall.film.features.normal.at(x, y)[2] = -1.0f;
  }
  const RadianceImage picture = wall.denoised();
  EXPECT_TRUE(is_finite(picture));
  EXPECT_NEAR(*picture.at(4, 12), 1e10f, 3e9f);
  EXPECT_NEAR(*picture.at(44, 12), 1e-3f, 3e-4f);
}

TEST(Denoiser, accepts_pictures_of_one_pixel_row_or_column) {
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(1, 40), std::pair(40, 1)}) {
    const Wall wall(width, height, 1, 3.0f);
    const RadianceImage picture = wall.denoised();
    for (const float value : picture.data()) EXPECT_NEAR(value, 3.0f, 1e-4f);
  }
}

TEST(Denoiser, keeps_the_gradient_of_a_sky_apart_from_the_ground) {
  Wall wall(32, 32, 2);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 32; ++x) {
      wall.set(x, y, 2, {10.0f + static_cast<float>(y), 10.0f + static_cast<float>(y)});
      std::fill_n(wall.film.features.normal.at(x, y), 3, 0.0f);
      *wall.film.features.distance.at(x, y) = 0.0f;
    }
  }
  const RadianceImage picture = wall.denoised();
  for (int y = 0; y < 16; ++y) EXPECT_NEAR(*picture.at(9, y), 10.0f + static_cast<float>(y), 0.05f);
  EXPECT_NEAR(*picture.at(9, 16), 1.0f, 1e-4f);
}

}  // namespace
}  // namespace cyclorama::denoise
