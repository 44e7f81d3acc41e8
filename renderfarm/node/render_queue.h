// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <tuple>
#include <utility>

#include "common/wire/nodes.pb.h"
#include "renderfarm/node/link_id.h"

namespace cyclorama {

class BlockRenderer;

/// A block that a head wants, until it has had its `end`.
struct BlockOrder {
  LinkId link = 0;
  wire::RenderBlock block{};
  std::shared_ptr<BlockRenderer> renderer{};  ///< Null when the scene was not loaded. Keeps the scene in memory.
  double rendered_before = 0.0;               ///< Seconds that the desk had rendered when it came.
  std::atomic<bool> cancelled = false;        ///< Set by the queue; read by the threads that render.
};

/// Which block a node works at next:
///
///   1. one that was cancelled, as it only wants its end,
///   2. the one of the lowest rank,
///   3. of those, the one that came first.
///
/// The block at work stays in the queue: asked again between two pieces of work, the queue says whether another has
/// come that goes first. Pure; thread-bound.
class RenderQueue {
 public:
  /// False when the link has a block of that number, or too many blocks: its head is broken.
  bool add(std::shared_ptr<BlockOrder> order);
  /// Nothing for an unknown number: its end is on its way.
  void cancel(LinkId link, std::uint64_t block);
  /// The block has had its end.
  void remove(LinkId link, std::uint64_t block);
  /// Cancels and removes all blocks of the link.
  void drop(LinkId link);

  /// Null without one. A block whose link `takes_tiles` no more waits, unless it was cancelled.
  [[nodiscard]] std::shared_ptr<const BlockOrder> next(const std::function<bool(LinkId)>& takes_tiles) const;
  [[nodiscard]] std::size_t size() const { return waiting_.size(); }

 private:
  using Name = std::pair<LinkId, std::uint64_t>;
  using Place = std::tuple<bool, std::uint64_t, std::uint64_t>;  ///< Wanted still; rank; number in order of coming.

  std::map<Place, std::shared_ptr<BlockOrder>> waiting_;
  std::map<Name, Place> places_;
  std::map<LinkId, std::size_t> blocks_of_;  ///< How many each link has here.
  std::uint64_t came_ = 0;
};

}  // namespace cyclorama
