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
#include "renderfarm/node/light_versions.h"
#include "renderfarm/node/node_link.h"
#include "renderfarm/node/render_queue.h"

namespace cyclorama::node {

/// A block that is being rendered tile by tile, and may be suspended between two pieces of work. Thread-bound.
class BlockWork {
 public:
  /// Called often, from any thread. `preempted` may become false again; preempted work is resumed later.
  struct Interrupts {
    std::function<bool()> cancelled;
    std::function<bool()> preempted;
  };

  /// Errors: one sentence on what is wrong with the order, such as a view out of range or a scene that is not loaded.
  static Result<BlockWork> begin(std::shared_ptr<const BlockOrder> order);

  /// Renders the next tile. Returns nothing if interrupted: by `cancelled` for good; by `preempted` with all finished
  /// cells kept, which only pictures at rest check, since one of their tiles may take a second. The first tile of a
  /// denoised block renders the block as a whole. Precondition: !is_done().
  std::optional<RenderedTile> next_tile(FilmStore& films, const Interrupts& interrupts);
  [[nodiscard]] bool is_done() const { return next_ == tiles_.size(); }
  /// Returns the cost of all tiles so far, including unfinished ones.
  [[nodiscard]] const render::RenderCost& cost() const { return cost_; }
  [[nodiscard]] const BlockOrder& order() const { return *order_; }

 private:
  /// The current tile of a picture at rest.
  struct Refining {
    FilmStore::Kept kept;
    render::Film prior;                        ///< Film of the picture with stored light, possibly unfinished.
    std::deque<governor::SampleRange> ranges;  ///< Samples that it lacks.
    render::Film part;                         ///< Film of the first range, possibly unfinished.
  };
  BlockWork(std::shared_ptr<const BlockOrder> order, const render::PanoramaView& view,
            std::optional<VersionedLight> light);

  /// Adds to the tile's stored sums, or starts them anew. Returns an empty picture if interrupted.
  RgbImage refined(const PixelRect& tile, FilmStore& films, const Interrupts& interrupts);
  /// Renders what the tile still lacks of the picture with stored light. Returns false if stopped.
  bool render_prior(const PixelRect& tile, const std::function<bool()>& stop);
  void add_cost(const render::RenderCost& cost, const PixelRect& rect);
  [[nodiscard]] const wire::RenderBlock& block() const { return order_->block; }

  std::shared_ptr<const BlockOrder> order_;
  render::PanoramaView view_;
  std::optional<VersionedLight> light_;  ///< The version that the view names; it stays while the block is rendered.
  std::vector<PixelRect> tiles_;
  std::size_t next_ = 0;
  render::RenderCost cost_;
  std::optional<Refining> refining_;
  RgbImage denoised_;  ///< Pixels of the whole block, once rendered.
  InverseDepthImage denoised_depth_;
};

}  // namespace cyclorama::node
