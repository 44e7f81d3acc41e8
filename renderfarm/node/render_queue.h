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

/// A block that a coordinator ordered, kept until its `end` is sent.
struct BlockOrder {
  LinkId link = 0;
  wire::RenderBlock block{};
  std::shared_ptr<BlockRenderer> renderer{};  ///< Keeps the scene in memory; null if the scene was not loaded.
  double rendered_before = 0.0;               ///< Seconds rendered by the worker before the order arrived.
  std::atomic<bool> cancelled = false;        ///< Set by the queue; read by the threads that render.
};

/// Chooses the block that a node works at next:
///
///   1. a cancelled one, since only its end is left to send,
///   2. one of a moving picture,
///   3. the one of the lowest rank,
///   4. among equals, the one that came first.
///
/// Ranks of different coordinators are not comparable, since each counts from its own start. A coordinator that had no
/// block here joins at the current rank, and its ranks continue from there for as long as it has blocks, as
/// start-time fair queueing treats a new session (coordinator/fair_share.h). The current block stays in the queue:
/// queried between two pieces of work, the queue returns another block if one has come that goes first. Pure;
/// thread-bound.
class RenderQueue {
 public:
  /// Returns false if the link has a block of that number, or too many blocks: its coordinator is broken.
  bool add(std::shared_ptr<BlockOrder> order);
  /// Ignores unknown numbers, because the block's end may already be on its way.
  void cancel(LinkId link, std::uint64_t block);
  /// Removes a block whose end was sent.
  void remove(LinkId link, std::uint64_t block);
  /// Cancels and removes all blocks of the link.
  void drop(LinkId link);

  /// Returns null if there is none. A block whose link fails `takes_tiles` waits, unless it was cancelled.
  [[nodiscard]] std::shared_ptr<const BlockOrder> next(const std::function<bool(LinkId)>& takes_tiles) const;
  [[nodiscard]] std::size_t size() const { return waiting_.size(); }

 private:
  using Name = std::pair<LinkId, std::uint64_t>;
  /// Still wanted; at rest; rank on this node's scale; order of arrival.
  using Place = std::tuple<bool, bool, double, std::uint64_t>;
  /// The moving pictures of a link, or its pictures at rest.
  struct Lane {
    std::size_t blocks = 0;
    double shift = 0.0;  ///< Offset from the coordinator's ranks to this node's scale, while there are blocks.
  };
  using Lanes = std::array<Lane, 2>;

  std::map<Place, std::shared_ptr<BlockOrder>> waiting_;
  std::map<Name, Place> places_;
  std::map<LinkId, Lanes> lanes_;
  std::array<double, 2> now_{};  ///< Latest rank that was done, of moving pictures and of pictures at rest.
  std::uint64_t arrivals_ = 0;
};

}  // namespace cyclorama::node
