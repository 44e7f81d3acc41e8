// SPDX-License-Identifier: Apache-2.0
/// The mean radiance of a view and its error. The error comes from pictures with different seeds, so it is correct even
/// if the samples of one picture are correlated.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "renderfarm/render/renderer.h"
#include "tests/data_sets/simple_scenes.h"

namespace cyclorama {

struct MeasuredLight {
  double mean = 0.0;
  double error = 0.0;  ///< Standard error of the mean.
};

inline std::unique_ptr<render::Renderer> built(scene::Scene scene, int threads = 1) {
  auto renderer = render::Renderer::build(std::move(scene), threads, nullptr);
  EXPECT_TRUE(renderer.has_value()) << renderer.error().message();
  return *std::move(renderer);
}

inline render::Film film_of(const render::Renderer& renderer, const render::PanoramaView& view, const PixelRect& rect) {
  render::Film film;
  renderer.render_film(view, rect, false, &film, nullptr);
  return film;
}
inline render::Film film_of(const render::Renderer& renderer, const render::PanoramaView& view) {
  return film_of(renderer, view, {0, 0, view.picture().width_px(), view.picture().height_px()});
}

/// Returns the mean over all channels of the pictures with seeds 1 to `pictures`.
inline MeasuredLight measured(const render::Renderer& renderer, render::PanoramaView view, int pictures = 16) {
  double sum = 0.0;
  double square = 0.0;
  for (int i = 1; i <= pictures; ++i) {
    view.seed = static_cast<std::uint64_t>(i);
    const double mean = mean_of(film_of(renderer, view).mean());
    sum += mean;
    square += mean * mean;
  }
  const double mean = sum / pictures;
  return {mean, std::sqrt(std::max(0.0, square / pictures - mean * mean) / (pictures - 1))};
}

/// With 16 pictures, a deviation of more than five standard errors has a probability of 1 in 6000 (Student's t with 15
/// degrees of freedom). kFloatLoss allows for rounding.
inline constexpr double kMaxErrors = 5.0;
inline constexpr double kFloatLoss = 2e-4;

inline void expect_light(const MeasuredLight& light, double expected) {
  EXPECT_NEAR(light.mean, expected, kMaxErrors * light.error + kFloatLoss * expected) << "error " << light.error;
}
inline void expect_same_light(const MeasuredLight& a, const MeasuredLight& b) {
  expect_light({a.mean, std::hypot(a.error, b.error)}, b.mean);
}

/// Returns a view of 16 x 16 pixels from (0, 1, 1) that all see about the same point, (0, 0, 0).
inline render::PanoramaView view_of_one_point() {
  render::PanoramaView view = view_from({0, 1, 1}, 16, 16, -1.0 + 1e-4, -1.0 - 1e-4);
  view.panorama.azimuth_span_rad = 2e-4;
  return view;
}

}  // namespace cyclorama
