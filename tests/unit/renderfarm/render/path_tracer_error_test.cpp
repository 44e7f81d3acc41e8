// SPDX-License-Identifier: Apache-2.0
/// Decrease of the error with the number of samples, with and without adaptive sampling.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "common/image/colour.h"
#include "renderfarm/render/tone.h"
#include "renderfarm/render/vectors.h"
#include "tests/data_sets/mixed_room.h"
#include "tests/support/measured_light.h"

namespace cyclorama::render {
namespace {

/// Half the mean squared difference of two pictures is the variance of one.
double squared_error(const Renderer& renderer, PanoramaView view) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::uint64_t seed = 1; seed < 9; seed += 2) {
    view.seed = seed;
    const RadianceImage a = film_of(renderer, view).mean();
    view.seed = seed + 1;
    const RadianceImage b = film_of(renderer, view).mean();
    for (std::size_t i = 0; i < a.data().size(); ++i) {
      const auto gap = static_cast<double>(a.data()[i] - b.data()[i]);
      sum += 0.5 * gap * gap;
    }
    count += a.data().size();
  }
  return sum / static_cast<double>(count);
}

TEST(PathTracerError, falls_at_least_in_proportion_to_the_samples) {
  scene::Scene scene = scene_of(sphere_mesh(3.0f, 12), {0.7f, 0.6f, 0.5f});
  scene.model.materials.push_back(white_material(0.5f, 1.0f));
  add_mesh(scene, sphere_mesh(0.6f, 8, 1), Eigen::Affine3d(Eigen::Translation3d(0.5, -0.6, -1.6)));
  scene::Light light;
  light.kind = scene::LightKind::kRectangle;
  light.position = {0.0, 1.8, -0.5};
  light.size_m = {1.0, 0.6};
  light.intensity.setConstant(5.0f);
  light.visible = true;
  scene.model.lights = {light};
  const auto renderer = built(std::move(scene));
  std::vector<double> errors;
  for (const int samples : {4, 16, 64, 256}) errors.push_back(squared_error(*renderer, room_view(4, samples)));
  for (std::size_t i = 1; i < errors.size(); ++i) EXPECT_LT(errors[i], errors[i - 1] / 2.5) << i;
  const double slope = std::log(errors.back() / errors.front()) / std::log(256.0 / 4.0);
  EXPECT_LT(slope, -0.93) << errors.front() << " to " << errors.back();
}

/// A lamp at the corner of four pixels, `size` pixels wide, and nothing else.
std::unique_ptr<Renderer> lamp_in_the_dark(double size) {
  scene::Scene scene = scene_of(square_mesh(0.01f));
  scene::Light lamp;
  lamp.kind = scene::LightKind::kRectangle;
  lamp.position = {0, 3, -4};
  lamp.direction = {0, 0, 1};
  lamp.size_m = {size, size};
  lamp.intensity.setConstant(1.0f);
  lamp.visible = true;
  scene.model.lights = {lamp};
  return built(std::move(scene));
}

/// The samples of a pixel are evenly distributed: a feature as large as the cell of one of the first `adaptive_minimum`
/// samples is certainly found. A smaller one may be missed, and is then never sampled.
TEST(PathTracerError, adaptive_sampling_misses_nothing_that_its_first_samples_hit) {
  PanoramaView view = view_from({0, 3, 0}, 16, 16, 2.0, -2.0);
  view.panorama.azimuth_span_rad = 4.0;
  view.quality.samples = 256;
  for (const auto& [size, minimum] : {std::pair{0.52, 16}, std::pair{0.27, 64}}) {
    SCOPED_TRACE(size);
    const auto renderer = lamp_in_the_dark(size);
    view.quality.adaptive_error = 0.0f;
    const MeasuredLight all = measured(*renderer, view);
    view.quality.adaptive_error = 0.01f;
    view.quality.adaptive_minimum = minimum;
    expect_same_light(measured(*renderer, view), all);
    const Film film = film_of(*renderer, view);
    EXPECT_EQ(*film.samples.at(0, 0), minimum);
    for (const std::int32_t samples : film.samples.data()) {
      EXPECT_GE(samples, minimum);
      EXPECT_LE(samples, view.quality.samples);
    }
  }
}

TEST(PathTracerError, adaptive_sampling_reaches_the_requested_error) {
  const auto renderer = built(mixed_room());
  PanoramaView view = room_view(3, 1024);
  double before = 1.0;
  for (const float asked : {0.1f, 0.05f}) {
    view.quality.adaptive_error = asked;
    double sum = 0.0;
    std::size_t count = 0;
    for (std::uint64_t seed = 1; seed < 5; seed += 2) {
      view.seed = seed;
      const RadianceImage a = film_of(*renderer, view).mean();
      view.seed = seed + 1;
      const RadianceImage b = film_of(*renderer, view).mean();
      const auto shown = [](const RadianceImage& image, std::size_t pixel) {
        const float* const rgb = &image.data()[3 * pixel];
        const float light = luminance(Vec3(rgb[0], rgb[1], rgb[2]));
        return static_cast<double>(linear_to_srgb(tone_mapped(light, scene::ToneCurve::kShoulder)));
      };
      count += a.data().size() / 3;
      for (std::size_t i = 0; i < a.data().size() / 3; ++i) sum += 0.5 * std::pow(shown(a, i) - shown(b, i), 2.0);
    }
    const double error = std::sqrt(sum / static_cast<double>(count));
    EXPECT_LT(error, static_cast<double>(asked));
    EXPECT_LT(error, 0.8 * before);
    before = error;
  }
}

}  // namespace
}  // namespace cyclorama::render
