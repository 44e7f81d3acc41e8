// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/extremes/picture_case.h"

#include <cmath>
#include <iterator>

#include "common/base/clock.h"
#include "renderfarm/denoise/denoise.h"
#include "renderfarm/denoise/pixel_rays.h"

namespace cyclorama {
namespace {

template <typename Pixels>
bool is_finite_at(const Pixels& pixels, int x, int y) {
  for (std::size_t c = 0; c < Pixels::kChannels; ++c) {
    if (!std::isfinite(pixels.at(x, y)[c])) return false;
  }
  return true;
}

bool is_black_at(const RadianceImage& pixels, int x, int y) {
  const float* const rgb = pixels.at(x, y);
  return !(rgb[0] > 0.0f || rgb[1] > 0.0f || rgb[2] > 0.0f);
}

}  // namespace

std::vector<PictureCase> all_picture_cases() {
  std::vector<PictureCase> cases = surface_cases();
  std::vector<PictureCase> more = light_cases();
  cases.insert(cases.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  return cases;
}

Result<PictureVerdict> judge(const PictureCase& extreme, const std::filesystem::path& scratch, int threads) {
  TRY_ASSIGN(ExtremePicture picture, extreme.make(scratch));
  const SteadyClock clock;
  const TimePoint start = clock.now();
  TRY_ASSIGN(const std::unique_ptr<render::Renderer> renderer,
             render::Renderer::build(std::move(picture.scene), threads, nullptr));
  const Panorama& panorama = picture.view.panorama;
  const PixelRect whole{0, 0, panorama.width_px, panorama.height_px};
  TRY(render::check_view(picture.view, whole));
  render::Film film;
  const render::RenderCost cost = renderer->render_film(picture.view, whole, true, &film, nullptr);
  PictureVerdict verdict;
  verdict.seconds = to_seconds(clock.now() - start);
  verdict.broken_samples = cost.broken_samples;
  const RadianceImage mean = film.mean();
  const render::ScalarImage variance = film.variance();
  const RadianceImage smooth =
      denoise::denoised(film, denoise::panorama_rays(panorama, picture.view.heading_rad, whole));
  for (int y = 0; y < film.height(); ++y) {
    for (int x = 0; x < film.width(); ++x) {
      const bool finite = is_finite_at(mean, x, y) && is_finite_at(variance, x, y) && is_finite_at(smooth, x, y) &&
                          is_finite_at(film.features.albedo, x, y) && is_finite_at(film.features.normal, x, y) &&
                          is_finite_at(film.features.distance, x, y);
      ++verdict.pixels;
      if (!finite) ++verdict.not_finite;
      if (is_black_at(mean, x, y) || is_black_at(smooth, x, y)) ++verdict.black;
    }
  }
  return verdict;
}

}  // namespace cyclorama
