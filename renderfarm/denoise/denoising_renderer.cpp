// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/denoise/denoising_renderer.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <numeric>
#include <utility>

#include "common/base/clock.h"
#include "common/base/cpu_time.h"
#include "common/base/picture_cut.h"
#include "common/image/cells.h"
#include "common/image/cropped.h"
#include "renderfarm/render/tone.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::denoise {
namespace {

/// Minimum height of a strip: each has margins of its own, which are filtered twice.
constexpr int kMinStripPx = 64;

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

/// Returns a film's cost for the cells that `rect` touches. The cost of the margin and of denoising is spread evenly
/// over all cells, because other cuts have their margins elsewhere.
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

/// Puts one image below another of the same width.
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

DenoisingRenderer::DenoisingRenderer(const render::Renderer& renderer, int threads)
    : renderer_(renderer),
      denoisers_(static_cast<std::size_t>(threads > 0 ? threads : tbb::this_task_arena::max_concurrency())) {}

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
  CHECK(check_denoisable(view).has_value());
  const Projection picture = view.picture();
  const int height = height_px(picture.shape);
  const PixelRect first{0, 0, picture.width_px(), height};
  const PixelRect second{0, height, picture.width_px(), height};
  const PixelRect upper = rows_within(rect, first);
  const PixelRect lower = rows_within(rect, second);
  if (picture.stacked() == 1 || lower.empty())
    return render_within(view, first, rect, ret_pixels, cancelled, ret_depth);
  if (upper.empty()) return render_within(view, second, rect, ret_pixels, cancelled, ret_depth);
  RadianceImage part;
  InverseDepthImage part_depth;
  render::RenderCost cost = render_within(view, first, upper, ret_pixels, cancelled, ret_depth);
  add(render_within(view, second, lower, &part, cancelled, &part_depth), &cost);
  append_below(part, ret_pixels);
  if (ret_depth != nullptr) append_below(part_depth, ret_depth);
  return cost;
}

render::RenderCost DenoisingRenderer::render_within(const render::PanoramaView& view, const PixelRect& bounds,
                                                    const PixelRect& rect, RadianceImage* ret_pixels,
                                                    const std::function<bool()>& cancelled,
                                                    InverseDepthImage* ret_depth) {
  const PixelRect wide = rect.empty() ? rect : grown(rect, Denoiser::halo_px(), bounds);
  render::RenderCost cost = renderer_.render_film(view, wide, true, &film_, cancelled);
  if (ret_depth != nullptr) *ret_depth = depth_of(film_, wide, rect);
  if (rect.empty() || (cancelled && cancelled())) {
    *ret_pixels = RadianceImage(rect.width, rect.height);
    return has_cell_times(std::move(cost), wide, rect);
  }
  const TimePoint start = SteadyClock().now();
  const double cpu_start = thread_cpu_seconds();
  const PixelRays rays = picture_rays(view.picture(), view.heading_rad, wide);
  if (wide_.width() != wide.width || wide_.height() != wide.height) wide_ = RadianceImage(wide.width, wide.height);
  const PixelRect part{rect.x - wide.x, rect.y - wide.y, rect.width, rect.height};
  const int threads = static_cast<int>(denoisers_.size());
  const int strips = std::clamp(rect.height / kMinStripPx, 1, threads);
  std::atomic<double> cpu_seconds = thread_cpu_seconds() - cpu_start;
  const auto strip = [&](int index) {
    const double before = thread_cpu_seconds();
    const int top = part.height * index / strips;
    const int bottom = part.height * (index + 1) / strips;
    denoisers_[static_cast<std::size_t>(index)].denoise(film_, rays, {part.x, part.y + top, part.width, bottom - top},
                                                        &wide_);
    cpu_seconds += thread_cpu_seconds() - before;
  };
  if (strips == 1) {
    strip(0);
  } else {
    tbb::task_arena(threads).execute([&] { tbb::parallel_for(0, strips, strip, tbb::simple_partitioner()); });
  }
  *ret_pixels = cropped(wide_, part);
  cost.cpu_seconds += cpu_seconds;
  cost.wall_seconds += to_seconds(SteadyClock().now() - start);
  return has_cell_times(std::move(cost), wide, rect);
}

}  // namespace cyclorama::denoise
