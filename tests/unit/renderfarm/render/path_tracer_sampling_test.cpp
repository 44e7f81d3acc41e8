// SPDX-License-Identifier: Apache-2.0
/// Sums of samples do not depend on how a picture is divided.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/data_sets/mixed_room.h"
#include "tests/support/measured_light.h"

namespace cyclorama::render {
namespace {

constexpr int kWidth = 35;
constexpr int kHeight = 20;

/// Neither is a multiple of a cell.
PanoramaView small_view(int samples) {
  PanoramaView view = room_view(3, samples);
  view.panorama.width_px = kWidth;
  view.panorama.height_px = kHeight;
  view.seed = 0x123456789abcdefu;
  return view;
}

struct NamedView {
  std::string name;
  PanoramaView view;
};

std::vector<NamedView> views() {
  std::vector<NamedView> all = {{"panorama", small_view(3)}};
  all.push_back({"both eyes", small_view(2)});
  Viewing both;
  both.eyes = Eyes::kOverUnder;
  both.eye_distance_m = 0.063;
  both.screen_distance_m = 3.0;
  all.back().view.projection = Projection{all.back().view.panorama, both};
  all.push_back({"fisheye", small_view(3)});
  all.back().view.projection = Projection{Fisheye{kWidth, kHeight, 3.0, 0.5}, {}};
  all.push_back({"adaptive", small_view(32)});
  all.back().view.quality.adaptive_error = 0.02f;
  all.push_back({"many aims", small_view(4)});
  all.back().view.quality.light_samples = 5;
  return all;
}

void expect_same_part(const Film& whole, const Film& part, const PixelRect& rect) {
  for (int y = 0; y < rect.height; ++y) {
    for (int x = 0; x < rect.width; ++x) {
      const int column = rect.x + x;
      const int row = rect.y + y;
      ASSERT_EQ(*part.samples.at(x, y), *whole.samples.at(column, row)) << column << ", " << row;
      ASSERT_EQ(*part.square.at(x, y), *whole.square.at(column, row)) << column << ", " << row;
      for (int c = 0; c < 3; ++c) {
        ASSERT_EQ(part.sum.at(x, y)[c], whole.sum.at(column, row)[c]) << column << ", " << row;
      }
    }
  }
}

TEST(PathTracerSampling, is_independent_of_the_number_of_threads) {
  std::vector<std::unique_ptr<Renderer>> renderers;
  for (const int threads : {1, 2, 4}) renderers.push_back(built(mixed_room(), threads));
  for (const NamedView& at : views()) {
    SCOPED_TRACE(at.name);
    const Film film = film_of(*renderers[0], at.view);
    EXPECT_GT(mean_of(film.sum), 0.0);
    for (std::size_t i = 1; i < renderers.size(); ++i) {
      const Film other = film_of(*renderers[i], at.view);
      EXPECT_EQ(other.sum, film.sum);
      EXPECT_EQ(other.square, film.square);
      EXPECT_EQ(other.samples, film.samples);
    }
  }
}

TEST(PathTracerSampling, is_independent_of_the_tiling) {
  const auto renderer = built(mixed_room(), 2);
  for (const NamedView& at : views()) {
    const int width = at.view.picture().width_px();
    const int height = at.view.picture().height_px();
    const Film film = film_of(*renderer, at.view);
    for (const auto& [tile_width, tile_height] : {std::pair{16, 16}, std::pair{23, 7}, std::pair{kWidth, 11}}) {
      SCOPED_TRACE(at.name + ", tiles of " + std::to_string(tile_width) + " x " + std::to_string(tile_height));
      for (int y = 0; y < height; y += tile_height) {
        for (int x = 0; x < width; x += tile_width) {
          const PixelRect rect{x, y, std::min(tile_width, width - x), std::min(tile_height, height - y)};
          expect_same_part(film, film_of(*renderer, at.view, rect), rect);
        }
      }
    }
  }
}

/// Float sums in the same order are identical, and in another order agree to rounding.
TEST(PathTracerSampling, gives_the_same_picture_in_steps_as_at_once) {
  constexpr int kSamples = 8;
  const auto renderer = built(mixed_room());
  for (NamedView at : views()) {
    if (at.view.quality.adaptive_error > 0.0f) continue;  // Steps do not share their error estimates.
    at.view.quality.samples = kSamples;
    const Film film = film_of(*renderer, at.view);
    at.view.quality.sequence = kSamples;
    for (const int step : {1, 4}) {
      SCOPED_TRACE(at.name + ", steps of " + std::to_string(step));
      Film sum;
      for (int first = 0; first < kSamples; first += step) {
        at.view.quality.first_sample = first;
        at.view.quality.samples = step;
        Film part = film_of(*renderer, at.view);
        if (first == 0) {
          sum = std::move(part);
        } else {
          sum.add(part);
        }
      }
      EXPECT_EQ(sum.samples, film.samples);
      for (std::size_t i = 0; i < film.sum.data().size(); ++i) {
        const float expected = film.sum.data()[i];
        ASSERT_NEAR(sum.sum.data()[i], expected, step == 1 ? 0.0f : 1e-6f * expected) << i;
      }
    }
  }
}

}  // namespace
}  // namespace cyclorama::render
