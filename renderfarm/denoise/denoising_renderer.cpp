// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/denoise/denoising_renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <numeric>
#include <utility>

#include "common/base/clock.h"
#include "common/base/cpu_time.h"
#include "common/base/picture_cut.h"
#include "common/image/cells.h"
#include "common/image/cropped.h"
#include "renderfarm/render/crew.h"
#include "renderfarm/render/sample_pieces.h"
#include "renderfarm/render/tone.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::denoise {
namespace {

/// Size of a strip, which one thread filters in some milliseconds. The margins of each strip are filtered twice.
constexpr int kStripHeightPx = 96;
constexpr int kStripWidthPx = 512;

/// Returns `rect` extended by `px` on each side, clipped to the picture.
PixelRect grown(const PixelRect& rect, int px, const PixelRect& picture) {
  const int left = std::max(picture.x, rect.x - px);
  const int top = std::max(picture.y, rect.y - px);
  return {left, top, std::min(picture.x + picture.width, rect.x + rect.width + px) - left,
          std::min(picture.y + picture.height, rect.y + rect.height + px) - top};
}

/// Returns the rows of `rect` inside `bounds`, which spans the same columns; may be empty.
PixelRect rows_within(const PixelRect& rect, const PixelRect& bounds) {
  const int top = std::max(rect.y, bounds.y);
  const int bottom = std::min(rect.y + rect.height, bounds.y + bounds.height);
  return {rect.x, top, rect.width, std::max(bottom - top, 0)};
}

void add(const render::RenderCost& part, render::RenderCost* sum) {
  sum->cpu_seconds += part.cpu_seconds;
  sum->wall_seconds += part.wall_seconds;
  sum->rays += part.rays;
  sum->removed_light = std::max(sum->removed_light, part.removed_light);
  sum->broken_samples += part.broken_samples;
  sum->cell_cpu_seconds.insert(sum->cell_cpu_seconds.end(), part.cell_cpu_seconds.begin(), part.cell_cpu_seconds.end());
}

/// Adds the cost of further samples of the same cells.
void add_same_cells(const render::RenderCost& more, render::RenderCost* sum) {
  CHECK(more.cell_cpu_seconds.size() == sum->cell_cpu_seconds.size());
  std::vector<float> cells = std::move(sum->cell_cpu_seconds);
  std::ranges::transform(cells, more.cell_cpu_seconds, cells.begin(), std::plus<>());
  add(more, sum);
  sum->cell_cpu_seconds = std::move(cells);
}

/// Returns a film's cost for the cells that `rect` touches. The cost of the margin and of denoising is distributed
/// evenly over these cells, because other cuts would have their margins elsewhere.
render::RenderCost has_cell_times(render::RenderCost cost, const PixelRect& wide, const PixelRect& rect) {
  const PixelRect from = cells_touched(wide);
  const PixelRect cells = cells_touched(rect);
  std::vector<float> inside;
  for (int row = cells.y; row < cells.y + cells.height; ++row) {
    for (int column = cells.x; column < cells.x + cells.width; ++column) {
      inside.push_back(cost.cell_cpu_seconds[cell_index(from, column, row)]);
    }
  }
  const double traced = std::accumulate(inside.begin(), inside.end(), 0.0);
  const double rest = (cost.cpu_seconds - traced) / static_cast<double>(std::max<std::size_t>(1, inside.size()));
  for (float& seconds : inside) seconds += static_cast<float>(rest);
  cost.cell_cpu_seconds = std::move(inside);
  return cost;
}

/// Returns the depth of the cells that `rect` touches from a film of `wide`; empty if the film has none.
InverseDepthImage depth_of(const render::Film& film, const PixelRect& wide, const PixelRect& rect) {
  if (film.depth.empty()) return {};
  const PixelRect from = depth_cells(wide);
  const PixelRect cells = depth_cells(rect);
  return cropped(film.depth, {cells.x - from.x, cells.y - from.y, cells.width, cells.height});
}

/// Appends an image below another of the same width.
template <typename Pixels>
void append_below(const Pixels& lower, Pixels* upper) {
  const Pixels above = std::exchange(*upper, Pixels(lower.width(), upper->height() + lower.height()));
  const auto end = std::ranges::copy(above.data(), upper->data().begin()).out;
  std::ranges::copy(lower.data(), end);
}

}  // namespace

Status check_denoisable(const render::PanoramaView& view) {
  const Projection picture = view.picture();
  if (picture.stacked() == 1 || height_px(picture.shape) % kCutPx == 0) return Done{};
  return Error(
      ErrorCode::kInvalidArgument,
      fmt::format("stereo pictures of {} pixels in height per eye cannot be denoised; make the height a multiple of {}",
                  height_px(picture.shape), kCutPx));
}

render::RenderCost DenoisingRenderer::render(const render::PanoramaView& view, const PixelRect& rect,
                                             RgbImage* ret_pixels, const std::function<bool()>& cancelled,
                                             InverseDepthImage* ret_depth) {
  RadianceImage light;
  const render::RenderCost cost = render_radiance(view, rect, &light, cancelled, ret_depth);
  *ret_pixels = render::developed(light, renderer_.scene().tone);
  return cost;
}

render::RenderCost DenoisingRenderer::render_radiance(const render::PanoramaView& view, const PixelRect& rect,
                                                      RadianceImage* ret_pixels, const std::function<bool()>& cancelled,
                                                      InverseDepthImage* ret_depth) {
  UnfinishedPicture picture;
  InverseDepthImage depth;
  render::RenderCost cost = advance(view, rect, &picture, cancelled, ret_pixels, &depth);
  if (!picture.is_done()) *ret_pixels = RadianceImage(rect.width, rect.height);
  if (ret_depth != nullptr) *ret_depth = std::move(depth);
  return cost;
}

render::RenderCost DenoisingRenderer::advance(const render::PanoramaView& view, const PixelRect& rect,
                                              UnfinishedPicture* picture, const std::function<bool()>& stop,
                                              RadianceImage* ret_pixels, InverseDepthImage* ret_depth) {
  CHECK(check_denoisable(view).has_value() && !picture->is_done());
  const Projection shape = view.picture();
  const int height = height_px(shape.shape);
  const PixelRect first{0, 0, shape.width_px(), height};
  const PixelRect second{0, height, shape.width_px(), height};
  const PixelRect upper = rows_within(rect, first);
  const PixelRect lower = rows_within(rect, second);
  auto& [upper_part, lower_part] = picture->parts_;
  if (shape.stacked() == 1 || lower.empty() || upper.empty()) {
    const bool is_second = shape.stacked() > 1 && !lower.empty();
    render::RenderCost cost =
        advance_within(view, is_second ? second : first, rect, &upper_part, stop, ret_pixels, ret_depth);
    picture->done_ = upper_part.is_done;
    return cost;
  }
  RadianceImage below;
  InverseDepthImage below_depth;
  render::RenderCost cost = advance_within(view, first, upper, &upper_part, stop, ret_pixels, ret_depth);
  add(advance_within(view, second, lower, &lower_part, stop, &below, &below_depth), &cost);
  picture->done_ = upper_part.is_done && lower_part.is_done;
  if (!picture->done_) return cost;
  append_below(below, ret_pixels);
  append_below(below_depth, ret_depth);
  return cost;
}

render::RenderCost DenoisingRenderer::trace(const render::PanoramaView& view, const PixelRect& wide,
                                            UnfinishedPicture::Part* part, const std::function<bool()>& stop) const {
  render::RenderCost cost;
  cost.cell_cpu_seconds.resize(static_cast<std::size_t>(cells_touched(wide).area()));
  render::PanoramaView piece = view;
  if (piece.quality.sequence == 0) piece.quality.sequence = view.quality.first_sample + view.quality.samples;
  while (part->samples < view.quality.samples) {
    piece.quality.first_sample = view.quality.first_sample + part->samples;
    piece.quality.samples = std::min(render::max_samples_per_piece(view.quality), view.quality.samples - part->samples);
    if (part->piece.width() == 0) {
      part->piece = render::Film(wide.width, wide.height, true);
      const PixelRect cells = depth_cells(wide);
      if (view.depth) part->piece.depth = InverseDepthImage(cells.width, cells.height);
    }
    add_same_cells(renderer_.finish_film(piece, wide, &part->piece, stop), &cost);
    if (stop()) return cost;
    if (part->samples == 0) {
      part->film = std::move(part->piece);
    } else {
      part->film.add(part->piece);
    }
    part->piece = {};
    part->samples += piece.quality.samples;
  }
  return cost;
}

PixelRays DenoisingRenderer::rays_of(const render::PanoramaView& view, const PixelRect& wide,
                                     double* cpu_seconds) const {
  constexpr int kRows = 16;  // A thread finds them in less than a millisecond.
  PixelRays rays{RadianceImage(wide.width, wide.height)};
  std::atomic<double> seconds = 0.0;
  renderer_.crew().run((wide.height + kRows - 1) / kRows, [&](int index) {
    const double before = thread_cpu_seconds();
    const int top = index * kRows;
    const PixelRays some = picture_rays(view.picture(), view.heading_rad,
                                        {wide.x, wide.y + top, wide.width, std::min(kRows, wide.height - top)});
    std::ranges::copy(some.directions.data(), rays.directions.at(0, top));
    if (index == 0) rays.radians_per_px = some.radians_per_px;
    seconds += thread_cpu_seconds() - before;
  });
  *cpu_seconds += seconds;
  return rays;
}

double DenoisingRenderer::denoise(const PixelRect& wide, const PixelRect& rect, UnfinishedPicture::Part* part,
                                  const std::function<bool()>& stop) {
  const int rows = std::max(1, rect.height / kStripHeightPx);
  const int columns = std::max(1, rect.width / kStripWidthPx);
  if (part->strips.empty()) {
    part->strips.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns));
    part->wide = RadianceImage(wide.width, wide.height);
  }
  std::atomic<double> cpu_seconds = 0.0;
  const auto strip = [&](int index) {
    if (part->strips[static_cast<std::size_t>(index)] != 0 || stop()) return;
    const double before = thread_cpu_seconds();
    const auto cut = [](int length, int i, int count) { return static_cast<int>(std::int64_t{length} * i / count); };
    const int top = cut(rect.height, index / columns, rows);
    const int left = cut(rect.width, index % columns, columns);
    const PixelRect where{rect.x - wide.x + left, rect.y - wide.y + top,
                          cut(rect.width, index % columns + 1, columns) - left,
                          cut(rect.height, index / columns + 1, rows) - top};
    denoisers_.local().denoise(part->film, part->rays, where, &part->wide);
    part->strips[static_cast<std::size_t>(index)] = 1;
    cpu_seconds += thread_cpu_seconds() - before;
  };
  renderer_.crew().run(rows * columns, strip);
  return cpu_seconds;
}

render::RenderCost DenoisingRenderer::advance_within(const render::PanoramaView& view, const PixelRect& bounds,
                                                     const PixelRect& rect, UnfinishedPicture::Part* part,
                                                     const std::function<bool()>& stop, RadianceImage* ret_pixels,
                                                     InverseDepthImage* ret_depth) {
  const PixelRect wide = rect.empty() ? rect : grown(rect, Denoiser::halo_px(), bounds);
  // `stopped` stays true once set; otherwise a film with gaps could be taken for a complete one.
  std::atomic<bool> stopped = false;
  const auto stop_for_good = [&] {
    if (!stopped && stop && stop()) stopped = true;
    return stopped.load();
  };
  if (rect.empty()) {
    part->is_done = true;
    *ret_pixels = RadianceImage(rect.width, rect.height);
    return {};
  }
  render::RenderCost cost = trace(view, wide, part, stop_for_good);
  if (!stop_for_good()) {
    const TimePoint start = SteadyClock().now();
    if (part->rays.directions.empty()) part->rays = rays_of(view, wide, &cost.cpu_seconds);
    cost.cpu_seconds += denoise(wide, rect, part, stop_for_good);
    cost.wall_seconds += to_seconds(SteadyClock().now() - start);
    part->is_done = std::ranges::all_of(part->strips, [](std::uint8_t done) { return done != 0; });
  }
  if (part->is_done) {
    *ret_pixels = cropped(part->wide, {rect.x - wide.x, rect.y - wide.y, rect.width, rect.height});
    *ret_depth = depth_of(part->film, wide, rect);
  }
  return has_cell_times(std::move(cost), wide, rect);
}

}  // namespace cyclorama::denoise
