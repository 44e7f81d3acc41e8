// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/block_work.h"

#include <fmt/format.h>

#include <atomic>
#include <utility>

#include "common/base/check.h"
#include "common/base/text.h"
#include "common/image/cells.h"
#include "common/image/cropped.h"
#include "common/image/watermark.h"
#include "renderfarm/balance/tiles.h"
#include "renderfarm/node/block_view.h"
#include "renderfarm/node/film_prior.h"

namespace cyclorama::node {
namespace {

/// Returns `part` as measured from the corner of `whole`.
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
  BlockRenderer& renderer = *order_->renderer;
  if (light_) renderer.use_light(*light_);
  RgbImage pixels;
  InverseDepthImage depth;  // A picture at rest needs none, since it is never shown from another eye.
  if (block().keep()) {
    pixels = refined(rect, films, interrupts);
  } else if (block().view().denoise()) {
    const PixelRect whole = rect_of(block());
    if (denoised_.empty()) {
      add_cost(renderer.render_denoised(view_, whole, &denoised_, &denoised_depth_, interrupts.cancelled), whole);
    }
    pixels = cropped(denoised_, relative(rect, whole));
    if (view_.depth) depth = cropped(denoised_depth_, relative(depth_cells(rect), depth_cells(whole)));
  } else {
    add_cost(renderer.render(view_, rect, &pixels, &depth, interrupts.cancelled), rect);
  }
  if (pixels.empty() || interrupts.cancelled()) return std::nullopt;
  ++next_;
  add_watermark(block().watermark(), rect, &pixels);
  return RenderedTile{block().block(),   block().view().number(), rect,
                      std::move(pixels), std::move(depth),        jpeg_options_of(block())};
}

RgbImage BlockWork::refined(const PixelRect& tile, FilmStore& films, const Interrupts& interrupts) {
  const std::string picture = picture_name_of(block());
  if (!refining_) {
    const int wanted = static_cast<int>(block().view().first_sample() + block().view().samples());
    refining_.emplace();
    refining_->kept = films.take({order_->link, block().session()}, picture, tile);
    FilmStore::Kept& kept = refining_->kept;
    // More samples than wanted: the coordinator requests an earlier picture again.
    if (kept.samples == 0 || kept.samples > wanted) {
      kept.film = render::Film(tile.width, tile.height, false);
      kept.samples = 0;
    }
    for (const governor::SampleRange& range : governor::cut_samples({kept.samples, wanted}))
      refining_->ranges.push_back(range);
    kept.samples = wanted;
  }
  // It stays true once set; otherwise a film with holes would pass for a complete one.
  std::atomic<bool> stopped = false;
  const auto stop = [&] {
    if (!stopped && (interrupts.cancelled() || interrupts.preempted())) stopped = true;
    return stopped.load();
  };
  if (!render_prior(tile, stop)) return {};
  while (!refining_->ranges.empty()) {
    render::Film& part = refining_->part;
    if (part.width() == 0) part = render::Film(tile.width, tile.height, false);
    add_cost(order_->renderer->render_film(view_, tile, refining_->ranges.front(), &part, stop), tile);
    if (stopped) return {};
    refining_->kept.film.add(part);
    part = {};
    refining_->ranges.pop_front();
  }
  const FilmStore::Kept& kept = refining_->kept;
  RgbImage pixels = order_->renderer->developed(mean_with_prior(kept.film, kept.prior, prior_weight_of(block())));
  films.put({order_->link, block().session()}, picture, tile, std::move(refining_->kept));
  refining_.reset();
  return pixels;
}

bool BlockWork::render_prior(const PixelRect& tile, const std::function<bool()>& stop) {
  const int samples = static_cast<int>(block().view().prior_samples());
  if (samples == 0 || !refining_->kept.prior.empty()) return true;
  render::Film& film = refining_->prior;
  if (film.width() == 0) film = render::Film(tile.width, tile.height, false);
  render::PanoramaView view = view_;
  view.quality.stored_light = true;
  view.quality.sequence = 0;  // These are the samples of the moving picture.
  add_cost(order_->renderer->render_film(view, tile, {0, samples}, &film, stop), tile);
  if (stop()) return false;
  refining_->kept.prior = film.mean();
  film = {};
  return true;
}

void BlockWork::add_cost(const render::RenderCost& cost, const PixelRect& rect) {
  cost_.cpu_seconds += cost.cpu_seconds;
  cost_.wall_seconds += cost.wall_seconds;
  cost_.rays += cost.rays;
  const PixelRect all = cells_touched(rect_of(block()));
  const PixelRect cells = cells_touched(rect);
  if (cost.cell_cpu_seconds.size() != static_cast<std::size_t>(cells.area())) return;  // Costs were not measured.
  auto seconds = cost.cell_cpu_seconds.begin();
  for (int row = cells.y; row < cells.y + cells.height; ++row) {
    for (int column = cells.x; column < cells.x + cells.width; ++column) {
      cost_.cell_cpu_seconds[cell_index(all, column, row)] += *seconds++;
    }
  }
}

}  // namespace cyclorama::node
