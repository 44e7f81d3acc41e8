// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/denoise/denoise.h"

#include <algorithm>
#include <utility>

#include "renderfarm/denoise/a_trous.h"

namespace cyclorama::denoise {
namespace {

constexpr int kSteps[] = {1, 2, 4};

/// Returns `rect` extended by `px` on each side, clipped to the film.
PixelRect grown(const PixelRect& rect, int px, const render::Film& film) {
  const int left = std::max(0, rect.x - px);
  const int top = std::max(0, rect.y - px);
  return {left, top, std::min(film.width(), rect.x + rect.width + px) - left,
          std::min(film.height(), rect.y + rect.height + px) - top};
}

}  // namespace

int Denoiser::halo_px() {
  int reach = kGuideReachPx;
  for (const int step : kSteps) reach += step;
  return reach;
}

void Denoiser::denoise(const render::Film& film, const PixelRays& rays, const PixelRect& part,
                       RadianceImage* ret_picture) {
  CHECK(part.x >= 0 && part.y >= 0 && part.width <= film.width() - part.x && part.height <= film.height() - part.y);
  CHECK(ret_picture->width() == film.width() && ret_picture->height() == film.height());
  if (part.empty()) return;
  const PixelRect wide = grown(part, halo_px(), film);
  maker_.make(film, rays, wide, &guide_);
  for (const int step : kSteps) {
    filter_level(guide_, guide_.light, step, &scratch_, &other_);
    std::swap(guide_.light, other_);
  }
  remodulate(guide_.light, {part.x - wide.x, part.y - wide.y, part.width, part.height}, film.features.albedo, part.x,
             part.y, ret_picture);
}

RadianceImage denoised(const render::Film& film, const PixelRays& rays) {
  RadianceImage picture(film.width(), film.height());
  Denoiser().denoise(film, rays, {0, 0, film.width(), film.height()}, &picture);
  return picture;
}

}  // namespace cyclorama::denoise
