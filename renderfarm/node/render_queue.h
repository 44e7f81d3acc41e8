// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
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

namespace cyclorama::node {

class BlockRenderer;

/// A block that a coordinator wants, until it has had its `end`.
struct BlockOrder {
  LinkId link = 0;
  wire::RenderBlock block{};
  std::shared_ptr<BlockRenderer> renderer{};  ///< Null when the scene was not loaded. Keeps the scene in memory.
  double rendered_before = 0.0;               ///< Seconds that the controller had rendered when it came.
  std::atomic<bool> cancelled = false;        ///< Set by the queue; read by the threads that render.
};

/// Which block a node works at next:
///
///   1. one that was cancelled, as it only wants its end,
///   2. one of a moving picture,
///   3. the one of the lowest rank,
///   4. of those, the one that came first.
///
/// Each coordinator's ranks count from where it began, so that they say nothing of another coordinator's. A coordinator that had no block
/// here joins at the rank that is being worked at, and its ranks go on from there for as long as it has blocks: what
/// start-time fair queueing does with a new session (coordinator/fair_share.h). The block at work stays in the queue: asked again between two pieces of work, the queue says whether another has
/// come that goes first. Pure; thread-bound.
class RenderQueue {
 public:
  /// False when the link has a block of that number, or too many blocks: its coordinator is broken.
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
  /// Wanted still; at rest; rank on this node's scale; number in order of coming.
  using Place = std::tuple<bool, bool, double, std::uint64_t>;
  /// A link's moving pictures, or those at rest.
  struct Lane {
    std::size_t blocks = 0;
    double shift = 0.0;  ///< From the coordinator's ranks to this node's scale, while there are blocks.
  };
  using Lanes = std::array<Lane, 2>;

  std::map<Place, std::shared_ptr<BlockOrder>> waiting_;
  std::map<Name, Place> places_;
  std::map<LinkId, Lanes> lanes_;
  std::array<double, 2> now_{};  ///< The rank that was done last, of moving pictures and of those at rest.
  std::uint64_t arrivals_ = 0;
};

}  // namespace cyclorama::node
