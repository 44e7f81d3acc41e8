// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "renderfarm/node/block_renderer.h"
#include "renderfarm/node/film_store.h"
#include "renderfarm/node/node_link.h"
#include "renderfarm/node/render_queue.h"
#include "renderfarm/render/crew.h"

namespace cyclorama::node {

/// A block that is rendered tile by tile and may be suspended between two pieces of work. Thread-bound.
class BlockWork {
 public:
  /// Both are called often, from any thread. `preempted` may become false again; preempted work is resumed later.
  struct Interrupts {
    std::function<bool()> cancelled;
    std::function<bool()> preempted;
  };

  /// Errors: one sentence on what is wrong with the order, such as a view out of range or a scene that is not loaded.
  static Result<BlockWork> begin(std::shared_ptr<const BlockOrder> order);

  /// Renders the next tiles together. Returns none if interrupted: after `cancelled` for good, after `preempted` with
  /// all finished cells kept. Of a denoised block these are all tiles, or as many as the memory limit allows, because
  /// the denoiser reads pixels around each; else as many as give each thread of the crew some cells; of a picture at
  /// rest, one. The crew finishes the tiles; the renderer has threads of its own. May throw std::bad_alloc.
  /// Precondition: !is_done().
  std::vector<RenderedTile> next_tiles(FilmStore& films, render::Crew& crew, const Interrupts& interrupts);
  [[nodiscard]] bool is_done() const { return next_ == tiles_.size(); }
  /// Returns a report if the block has taken much thread time since its last tile or report.
  [[nodiscard]] std::optional<wire::BlockProgress> progress();
  /// Returns the cost of all tiles so far, including unfinished ones.
  [[nodiscard]] const render::RenderCost& cost() const { return cost_; }
  [[nodiscard]] const BlockOrder& order() const { return *order_; }

 private:
  using Stop = std::function<bool()>;
  /// The current tile of a picture at rest, or tiles of one that is not denoised.
  struct Tracing {
    PixelRect rect;
    render::Film film;                         ///< Sum of the finished ranges.
    int samples = 0;                           ///< Number of samples in `film` when all ranges are finished.
    std::deque<governor::SampleRange> ranges;  ///< Samples that `film` still lacks.
    render::Film part;                         ///< Film of the first of `ranges`, possibly unfinished.
    RadianceImage prior;                       ///< FilmStore::Kept::prior of a picture at rest.
    render::Film prior_part;                   ///< Film from which `prior` is made, possibly unfinished.
  };
  /// Tiles of a denoised block that are rendered together.
  struct Denoising {
    PixelRect rect;
    std::unique_ptr<DenoisedWork> work;
  };
  /// Finished pixels, not tone mapped, and depth of `rect`.
  struct Finished {
    PixelRect rect;
    RadianceImage light;
    InverseDepthImage depth;
  };
  BlockWork(std::shared_ptr<const BlockOrder> order, const render::PanoramaView& view);

  /// The next three return nothing if they were stopped.
  std::optional<Finished> traced(std::int64_t max_px, const Stop& stop);
  /// Adds to the stored sums of the tile, or starts new sums.
  std::optional<Finished> refined(FilmStore& films, const Stop& stop);
  std::optional<Finished> denoised(const Stop& stop);
  /// Returns the tile `rect` of `finished` as it is sent.
  [[nodiscard]] RenderedTile tile_of(const Finished& finished, const PixelRect& rect) const;
  /// Renders the samples that the tile lacks. Returns false if it was stopped.
  bool finish_tracing(const PixelRect& tile, const Stop& stop);
  /// Renders the samples that the tile's prior lacks. Returns false if it was stopped.
  bool finish_prior(const PixelRect& tile, const Stop& stop);
  [[nodiscard]] render::Film new_film(const PixelRect& tile) const;
  /// Returns the rect of the tiles that are rendered together, beginning with the next tile: one, or whole rows of
  /// tiles up to `max_px`.
  [[nodiscard]] PixelRect next_rect(std::int64_t max_px) const;
  void add_cost(const render::RenderCost& cost, const PixelRect& rect);
  [[nodiscard]] const wire::RenderBlock& block() const { return order_->block; }

  std::shared_ptr<const BlockOrder> order_;
  render::PanoramaView view_;
  std::vector<PixelRect> tiles_;
  std::size_t next_ = 0;
  render::RenderCost cost_;
  double reported_seconds_ = 0.0;  ///< Thread time at the last tile or report.
  std::optional<Tracing> tracing_;
  std::optional<Denoising> denoising_;
};

}  // namespace cyclorama::node
