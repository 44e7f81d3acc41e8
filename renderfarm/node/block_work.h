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

namespace cyclorama::node {

/// A block that is being rendered, tile by tile, and may be left lying between two pieces of work. Thread-bound.
class BlockWork {
 public:
  /// Asked often, from any thread. `gives_way` may change its mind; what it stopped is gone on with.
  struct Interrupts {
    std::function<bool()> cancelled;
    std::function<bool()> preempted;
  };

  /// In one sentence what is wrong with the order: a view out of range, a scene that is not loaded.
  static Result<BlockWork> begin(std::shared_ptr<const BlockOrder> order);

  /// Renders the next tile. Nothing when it was interrupted: by `cancelled` for good; by `gives_way`, which only a
  /// picture at rest asks for, whose tiles may take a second, with all finished cells kept. The first tile of a block
  /// without noise renders the block as a whole. Precondition: !is_done().
  std::optional<RenderedTile> next_tile(FilmStore& films, const Interrupts& interrupts);
  [[nodiscard]] bool is_done() const { return next_ == tiles_.size(); }
  /// Of all tiles so far, and of what was begun.
  [[nodiscard]] const render::RenderCost& cost() const { return cost_; }
  [[nodiscard]] const BlockOrder& order() const { return *order_; }

 private:
  /// The tile at hand of a picture at rest.
  struct Refining {
    FilmStore::Kept kept;
    std::deque<governor::SampleRange> ranges;  ///< That it lacks.
    render::Film part;                         ///< Of the first of them, as far as it is.
  };
  BlockWork(std::shared_ptr<const BlockOrder> order, const render::PanoramaView& view);

  /// Adds to the sums that the store has of the tile, or begins them anew. Empty when interrupted.
  RgbImage refined(const PixelRect& tile, FilmStore& films, const Interrupts& interrupts);
  void add_cost(const render::RenderCost& cost, const PixelRect& rect);
  [[nodiscard]] const wire::RenderBlock& block() const { return order_->block; }

  std::shared_ptr<const BlockOrder> order_;
  render::PanoramaView view_;
  std::vector<PixelRect> tiles_;
  std::size_t next_ = 0;
  render::RenderCost cost_;
  std::optional<Refining> refining_;
  RgbImage denoised_;  ///< Of the whole block, once it is there.
};

}  // namespace cyclorama::node
