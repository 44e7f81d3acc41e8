// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/cell_sampling.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "common/image/colour.h"
#include "renderfarm/render/tone.h"

namespace cyclorama::render {
namespace {

/// Samples per pixel between two checks of the error.
constexpr int kRound = kPacketRays;

float displayed(const TraceView& view, double light) {
  return linear_to_srgb(tone_mapped(view.exposure * static_cast<float>(light), view.tone));
}

/// Returns the standard error of displayed luminance: half the difference between the displayed values of the mean plus
/// one standard error and of the mean minus one standard error.
float displayed_error(const TraceView& view, const CellFilm& film, std::size_t pixel) {
  const auto n = static_cast<double>(film.samples[pixel]);
  const double mean = static_cast<double>(luminance(film.sum[pixel])) / n;
  const double variance = std::max(0.0, static_cast<double>(film.square[pixel]) / n - mean * mean) / (n - 1.0);
  const double error = std::sqrt(variance);
  return 0.5f * (displayed(view, mean + error) - displayed(view, std::max(0.0, mean - error)));
}

/// Returns the difference from a neighbour, in codes, above which a pixel of stored light gets all of its samples. The
/// more samples a view has, the finer the differences to which they are applied. `./bench.sh light-equal-error` reports
/// the errors that remain.
int contrast_codes(int samples) { return std::clamp(80 / samples, 6, 24); }

}  // namespace

bool find_active(const TraceView& view, const TraceCell& cell, CellFilm& film) {
  std::array<float, kCellPixels> error{};
  for (int y = 0; y < cell.height; ++y) {
    for (int x = 0; x < cell.width; ++x) {
      const auto pixel = static_cast<std::size_t>(y * kCellPx + x);
      error[pixel] = displayed_error(view, film, pixel);
    }
  }
  bool any = false;
  for (int y = 0; y < cell.height; ++y) {
    for (int x = 0; x < cell.width; ++x) {
      float largest = 0.0f;
      for (int ny = std::max(0, y - 1); ny <= std::min(cell.height - 1, y + 1); ++ny) {
        for (int nx = std::max(0, x - 1); nx <= std::min(cell.width - 1, x + 1); ++nx) {
          largest = std::max(largest, error[static_cast<std::size_t>(ny * kCellPx + nx)]);
        }
      }
      const bool active = !(largest < view.quality.adaptive_error);
      film.active[static_cast<std::size_t>(y * kCellPx + x)] = active;
      any |= active;
    }
  }
  return any;
}

bool find_contrast(const TraceView& view, const TraceCell& cell, CellFilm& film) {
  const ToneTable& tone = tone_table(view.tone);
  const int contrast = contrast_codes(view.quality.samples);
  std::array<int, kCellPixels> shown{};
  for (int y = 0; y < cell.height; ++y) {
    for (int x = 0; x < cell.width; ++x) {
      const auto pixel = static_cast<std::size_t>(y * kCellPx + x);
      const auto count = static_cast<float>(std::max(film.samples[pixel], 1));
      shown[pixel] = tone.code(view.exposure * luminance(film.sum[pixel]) / count);
    }
  }
  bool any = false;
  for (int y = 0; y < cell.height; ++y) {
    for (int x = 0; x < cell.width; ++x) {
      const auto pixel = static_cast<std::size_t>(y * kCellPx + x);
      int largest = 0;
      for (int ny = std::max(0, y - 1); ny <= std::min(cell.height - 1, y + 1); ++ny) {
        for (int nx = std::max(0, x - 1); nx <= std::min(cell.width - 1, x + 1); ++nx) {
          largest = std::max(largest, std::abs(shown[static_cast<std::size_t>(ny * kCellPx + nx)] - shown[pixel]));
        }
      }
      film.active[pixel] = largest > contrast || film.lacks_light[pixel];
      any |= film.active[pixel];
    }
  }
  return any;
}

std::uint64_t sample_cell(const TraceScene& scene, ShadeStage shade, const TraceView& view, const TraceCell& cell,
                          PathBatch& batch, CellFilm& film) {
  const bool adaptive = view.quality.adaptive_error > 0.0f;
  if (view.quality.stored_light && view.light != nullptr && !adaptive) {
    TraceCell part = cell;
    part.first_sample = view.quality.first_sample;
    part.samples = 1;
    part.middle = true;
    const std::uint64_t rays = trace_cell(scene, shade, view, part, batch, film);
    if (view.quality.samples == 1 || !find_contrast(view, cell, film)) return rays;
    // The sample at the middle would have too much weight among samples that are spread evenly.
    film.restart_active();
    part.samples = view.quality.samples;
    part.middle = false;
    return rays + trace_cell(scene, shade, view, part, batch, film);
  }
  const int end = view.quality.first_sample + view.quality.samples;
  TraceCell part = cell;
  part.first_sample = view.quality.first_sample;
  part.samples = adaptive ? std::min(view.quality.adaptive_minimum, view.quality.samples) : view.quality.samples;
  std::uint64_t rays = 0;
  for (;;) {
    rays += trace_cell(scene, shade, view, part, batch, film);
    part.first_sample += part.samples;
    part.samples = std::min(kRound, end - part.first_sample);
    if (part.samples <= 0 || !find_active(view, cell, film)) return rays;
  }
}

}  // namespace cyclorama::render
