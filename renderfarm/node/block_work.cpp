// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/block_work.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <utility>

#include "common/base/check.h"
#include "common/base/text.h"
#include "common/image/cells.h"
#include "common/image/cropped.h"
#include "common/image/watermark.h"
#include "renderfarm/balance/tiles.h"
#include "renderfarm/node/block_view.h"
#include "renderfarm/node/film_prior.h"
#include "renderfarm/render/sample_pieces.h"

namespace cyclorama::node {
namespace {

/// Maximum number of pixels that are denoised together, so that a block of any size takes about 150 MB: 96 bytes per
/// pixel until it is done, and as much again while it is filtered. Each part has a margin that is rendered twice; the
/// larger the part, the smaller the share of its margin.
constexpr std::int64_t kMaxDenoisedPx = std::int64_t{1} << 20;

/// Returns `part` relative to the corner of `whole`.
PixelRect relative(const PixelRect& part, const PixelRect& whole) {
  return {part.x - whole.x, part.y - whole.y, part.width, part.height};
}

}  // namespace

Result<BlockWork> BlockWork::begin(std::shared_ptr<const BlockOrder> order) {
  TRY_ASSIGN(const render::PanoramaView view, view_of(order->block));
  if (order->renderer == nullptr) {
    return Error(ErrorCode::kNotFound, fmt::format("scene '{}' is not loaded", order->block.scene()));
  }
  std::optional<VersionedLight> light;
  if (const std::string& version = order->block.view().light(); !version.empty()) {
    const LightVersions* const known = order->renderer->light_versions();
    if (known != nullptr) light = known->find(version);
    if (!light) {
      return Error(ErrorCode::kNotFound, fmt::format("scene '{}' has no light of version '{}' here",
                                                     order->block.scene(), printable(version)));
    }
  }
  return BlockWork(std::move(order), view, std::move(light));
}

BlockWork::BlockWork(std::shared_ptr<const BlockOrder> order, const render::PanoramaView& view,
                     std::optional<VersionedLight> light)
    : order_(std::move(order)), view_(view), light_(std::move(light)), tiles_(balance::tiles_of(rect_of(block()))) {
  cost_.cell_cpu_seconds.resize(static_cast<std::size_t>(cells_touched(rect_of(block())).area()));
}

std::optional<RenderedTile> BlockWork::next_tile(FilmStore& films, const Interrupts& interrupts) {
  CHECK(!is_done());
  const PixelRect& rect = tiles_[next_];
  if (light_) order_->renderer->use_light(*light_);
  // `stopped` stays true once set; otherwise a film with gaps could be taken for a complete one.
  std::atomic<bool> stopped = false;
  const Stop stop = [&] {
    if (!stopped && (interrupts.cancelled() || interrupts.preempted())) stopped = true;
    return stopped.load();
  };
  RgbImage pixels;
  InverseDepthImage depth;  // Stays empty for a picture at rest, which is never shown from another eye.
  if (block().keep()) {
    pixels = refined(rect, films, stop);
  } else if (block().view().denoise()) {
    pixels = denoised(rect, stop, &depth);
  } else {
    pixels = traced(rect, stop, &depth);
  }
  if (pixels.empty() || interrupts.cancelled()) return std::nullopt;
  ++next_;
  reported_seconds_ = cost_.cpu_seconds;
  add_watermark(block().watermark(), rect, &pixels);
  return RenderedTile{block().block(),   block().view().number(), rect,
                      std::move(pixels), std::move(depth),        jpeg_options_of(block())};
}

std::optional<wire::BlockProgress> BlockWork::progress() {
  constexpr double kMinSeconds = 0.05;
  if (cost_.cpu_seconds - reported_seconds_ < kMinSeconds) return std::nullopt;
  reported_seconds_ = cost_.cpu_seconds;
  wire::BlockProgress report;
  report.set_block(block().block());
  report.set_render_cpu_seconds(cost_.cpu_seconds);
  return report;
}

render::Film BlockWork::new_film(const PixelRect& tile) const {
  render::Film film(tile.width, tile.height, false);
  const PixelRect cells = depth_cells(tile);
  if (view_.depth) film.depth = InverseDepthImage(cells.width, cells.height);
  return film;
}

bool BlockWork::finish_tracing(const PixelRect& tile, const Stop& stop) {
  while (!tracing_->ranges.empty()) {
    render::Film& part = tracing_->part;
    if (part.width() == 0) part = new_film(tile);
    add_cost(order_->renderer->render_film(view_, tile, tracing_->ranges.front(), &part, stop), tile);
    if (stop()) return false;
    tracing_->film.add(part);
    part = {};
    tracing_->ranges.pop_front();
  }
  return true;
}

RgbImage BlockWork::traced(const PixelRect& tile, const Stop& stop, InverseDepthImage* ret_depth) {
  if (!tracing_) {
    const governor::SampleRange all{view_.quality.first_sample, view_.quality.first_sample + view_.quality.samples};
    const auto ranges = governor::cut_evenly(all, render::max_samples_per_piece(view_.quality));
    tracing_ = Tracing{new_film(tile), view_.quality.samples, {ranges.begin(), ranges.end()}, {}, {}, {}};
  }
  if (!finish_tracing(tile, stop)) return {};
  RgbImage pixels = order_->renderer->developed(tracing_->film.mean());
  *ret_depth = std::move(tracing_->film.depth);
  tracing_.reset();
  return pixels;
}

RgbImage BlockWork::refined(const PixelRect& tile, FilmStore& films, const Stop& stop) {
  const std::string picture = picture_name_of(block());
  if (!tracing_) {
    const int wanted = static_cast<int>(block().view().first_sample() + block().view().samples());
    FilmStore::Kept kept = films.take({order_->link, block().session()}, picture, tile);
    // If there are more samples than wanted, the coordinator has requested an earlier picture again.
    if (kept.samples == 0 || kept.samples > wanted) {
      kept.film = new_film(tile);
      kept.samples = 0;
    }
    const auto ranges = governor::cut_samples({kept.samples, wanted}, render::max_samples_per_piece(view_.quality));
    tracing_ = Tracing{std::move(kept.film), wanted, {ranges.begin(), ranges.end()}, {}, std::move(kept.prior), {}};
  }
  if (!finish_prior(tile, stop) || !finish_tracing(tile, stop)) return {};
  RgbImage pixels =
      order_->renderer->developed(mean_with_prior(tracing_->film, tracing_->prior, prior_weight_of(block())));
  films.put({order_->link, block().session()}, picture, tile,
            {std::move(tracing_->film), tracing_->samples, std::move(tracing_->prior)});
  tracing_.reset();
  return pixels;
}

PixelRect BlockWork::next_denoised_rect() const {
  const PixelRect first = tiles_[next_];
  PixelRect all = first;
  for (std::size_t i = next_ + 1; i < tiles_.size(); ++i) {
    const PixelRect& tile = tiles_[i];
    const int right = std::max(all.x + all.width, tile.x + tile.width);
    const PixelRect more{all.x, all.y, right - all.x, tile.y + tile.height - all.y};
    if (tile.x < first.x || more.area() > kMaxDenoisedPx) break;
    all = more;
  }
  return all;
}

RgbImage BlockWork::denoised(const PixelRect& tile, const Stop& stop, InverseDepthImage* ret_depth) {
  if (!denoising_) {
    denoising_.emplace();
    denoising_->rect = next_denoised_rect();
    denoising_->work = order_->renderer->begin_denoised(view_, denoising_->rect);
  }
  const PixelRect& rect = denoising_->rect;
  if (denoising_->work != nullptr) {
    add_cost(denoising_->work->advance(stop, &denoising_->pixels, &denoising_->depth), rect);
    if (denoising_->pixels.empty()) return {};
    denoising_->work.reset();
  }
  RgbImage pixels = cropped(denoising_->pixels, relative(tile, rect));
  if (view_.depth) *ret_depth = cropped(denoising_->depth, relative(depth_cells(tile), depth_cells(rect)));
  const bool is_last = tile.x + tile.width == rect.x + rect.width && tile.y + tile.height == rect.y + rect.height;
  if (is_last) denoising_.reset();
  return pixels;
}

bool BlockWork::finish_prior(const PixelRect& tile, const Stop& stop) {
  const int samples = static_cast<int>(block().view().prior_samples());
  if (samples == 0 || !tracing_->prior.empty()) return true;
  render::Film& film = tracing_->prior_part;
  if (film.width() == 0) film = render::Film(tile.width, tile.height, false);
  render::PanoramaView view = view_;
  view.quality.stored_light = true;
  // The prior has the samples of the moving picture, whichever step of the refinement uses it.
  view.quality.first_sample = 0;
  view.quality.samples = samples;
  view.quality.sequence = 0;
  add_cost(order_->renderer->render_film(view, tile, {0, samples}, &film, stop), tile);
  if (stop()) return false;
  tracing_->prior = film.mean();
  film = {};
  return true;
}

void BlockWork::add_cost(const render::RenderCost& cost, const PixelRect& rect) {
  cost_.cpu_seconds += cost.cpu_seconds;
  cost_.wall_seconds += cost.wall_seconds;
  cost_.rays += cost.rays;
  const PixelRect all = cells_touched(rect_of(block()));
  const PixelRect cells = cells_touched(rect);
  if (cost.cell_cpu_seconds.size() != static_cast<std::size_t>(cells.area())) return;  // No costs were measured.
  auto seconds = cost.cell_cpu_seconds.begin();
  for (int row = cells.y; row < cells.y + cells.height; ++row) {
    for (int column = cells.x; column < cells.x + cells.width; ++column) {
      cost_.cell_cpu_seconds[cell_index(all, column, row)] += *seconds++;
    }
  }
}

}  // namespace cyclorama::node
