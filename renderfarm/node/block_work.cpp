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
/// Pixels of tiles that are traced together, for each thread: 32 cells, so that the threads end about together.
constexpr std::int64_t kTracedPxPerThread = 32 * std::int64_t{kCostCellPx} * kCostCellPx;

bool is_inside(const PixelRect& part, const PixelRect& whole) {
  return part.x >= whole.x && part.y >= whole.y && part.x + part.width <= whole.x + whole.width &&
         part.y + part.height <= whole.y + whole.height;
}

/// Returns `part` relative to the corner of `whole`.
PixelRect relative(const PixelRect& part, const PixelRect& whole) {
  return {part.x - whole.x, part.y - whole.y, part.width, part.height};
}

}  // namespace

Result<BlockWork> BlockWork::begin(std::shared_ptr<const BlockOrder> order) {
  TRY_ASSIGN(render::PanoramaView view, view_of(order->block));
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
  if (light) view.light = light->store;
  return BlockWork(std::move(order), view);
}

BlockWork::BlockWork(std::shared_ptr<const BlockOrder> order, const render::PanoramaView& view)
    : order_(std::move(order)), view_(view), tiles_(balance::tiles_of(rect_of(block()))) {
  cost_.cell_cpu_seconds.resize(static_cast<std::size_t>(cells_touched(rect_of(block())).area()));
}

std::vector<RenderedTile> BlockWork::next_tiles(FilmStore& films, render::Crew& crew, const Interrupts& interrupts) {
  CHECK(!is_done());
  // `stopped` stays true once set; otherwise a film with gaps could be taken for a complete one.
  std::atomic<bool> stopped = false;
  const Stop stop = [&] {
    if (!stopped && (interrupts.cancelled() || interrupts.preempted())) stopped = true;
    return stopped.load();
  };
  std::optional<Finished> finished;
  if (block().keep()) {
    finished = refined(films, stop);
  } else if (block().view().denoise()) {
    finished = denoised(stop);
  } else {
    finished = traced(kTracedPxPerThread * crew.threads(), stop);
  }
  if (!finished || interrupts.cancelled()) return {};
  const std::size_t first = next_;
  while (next_ < tiles_.size() && is_inside(tiles_[next_], finished->rect)) ++next_;
  reported_seconds_ = cost_.cpu_seconds;
  std::vector<RenderedTile> tiles(next_ - first);
  crew.run(static_cast<int>(tiles.size()), [&](int i) {
    const auto index = static_cast<std::size_t>(i);
    tiles[index] = tile_of(*finished, tiles_[first + index]);
  });
  return tiles;
}

RenderedTile BlockWork::tile_of(const Finished& finished, const PixelRect& rect) const {
  RgbImage pixels = order_->renderer->developed(cropped(finished.light, relative(rect, finished.rect)));
  add_watermark(block().watermark(), rect, &pixels);
  InverseDepthImage depth;
  if (!finished.depth.empty()) {
    depth = cropped(finished.depth, relative(depth_cells(rect), depth_cells(finished.rect)));
  }
  return {block().block(),   block().view().number(), rect,
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

std::optional<BlockWork::Finished> BlockWork::traced(std::int64_t max_px, const Stop& stop) {
  if (!tracing_) {
    const PixelRect rect = next_rect(max_px);
    const governor::SampleRange all{view_.quality.first_sample, view_.quality.first_sample + view_.quality.samples};
    const auto ranges = governor::cut_evenly(all, render::max_samples_per_piece(view_.quality));
    tracing_ = Tracing{rect, new_film(rect), view_.quality.samples, {ranges.begin(), ranges.end()}, {}, {}, {}};
  }
  if (!finish_tracing(tracing_->rect, stop)) return std::nullopt;
  Finished finished{tracing_->rect, tracing_->film.mean(), std::move(tracing_->film.depth)};
  tracing_.reset();
  return finished;
}

std::optional<BlockWork::Finished> BlockWork::refined(FilmStore& films, const Stop& stop) {
  const PixelRect& tile = tiles_[next_];
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
    tracing_ =
        Tracing{tile, std::move(kept.film), wanted, {ranges.begin(), ranges.end()}, {}, std::move(kept.prior), {}};
  }
  if (!finish_prior(tile, stop) || !finish_tracing(tile, stop)) return std::nullopt;
  // Without depth: a picture at rest is never shown from another eye.
  Finished finished{tile, mean_with_prior(tracing_->film, tracing_->prior, prior_weight_of(block())), {}};
  films.put({order_->link, block().session()}, picture, tile,
            {std::move(tracing_->film), tracing_->samples, std::move(tracing_->prior)});
  tracing_.reset();
  return finished;
}

PixelRect BlockWork::next_rect(std::int64_t max_px) const {
  const PixelRect first = tiles_[next_];
  PixelRect all = first;
  for (std::size_t i = next_ + 1; i < tiles_.size(); ++i) {
    const PixelRect& tile = tiles_[i];
    const int right = std::max(all.x + all.width, tile.x + tile.width);
    const PixelRect more{all.x, all.y, right - all.x, tile.y + tile.height - all.y};
    if (tile.x < first.x || more.area() > max_px) break;
    all = more;
  }
  return all;
}

std::optional<BlockWork::Finished> BlockWork::denoised(const Stop& stop) {
  if (!denoising_) {
    denoising_.emplace();
    denoising_->rect = next_rect(kMaxDenoisedPx);
    denoising_->work = order_->renderer->begin_denoised(view_, denoising_->rect);
  }
  Finished finished{denoising_->rect, {}, {}};
  add_cost(denoising_->work->advance(stop, &finished.light, &finished.depth), finished.rect);
  if (finished.light.empty()) return std::nullopt;
  denoising_.reset();
  return finished;
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
