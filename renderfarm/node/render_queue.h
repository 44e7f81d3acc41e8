// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <utility>

#include "common/wire/nodes.pb.h"
#include "common/wire/rank.h"
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
///   2. one of the earliest class of work (common/wire/rank.h): moving pictures, those at rest, spare work,
///   3. one of the account that has received the least,
///   4. of an account's blocks the one of the lowest rank, and among equals the one that came first.
///
/// The service received by an account starts at the rank of its first block, which its coordinator chose by what the account
/// got from the whole farm, and grows with the service that it really gets here (serve()), whatever its blocks were
/// predicted to cost. So a block that costs a thousand times as much as expected delays nobody, and many sessions of one
/// museum get no more than one. What an account that waits here gets from other nodes counts as soon as a block of another
/// account brings word of it (RenderBlock.received).
///
/// Ranks of different coordinators are not comparable, since each counts from its own start. A coordinator that had no
/// block here joins at the current rank, and its ranks continue from there for as long as it has blocks, as start-time
/// fair queueing treats a new session (coordinator/accounts.h). The current block stays in the queue: queried between
/// two pieces of work, the queue returns another block if one goes first by now. Pure; thread-bound.
class RenderQueue {
 public:
  using TakesTiles = std::function<bool(LinkId)>;

  /// Returns false if the link has a block of that number, or too many blocks: its coordinator is broken.
  bool add(std::shared_ptr<BlockOrder> order);
  /// Ignores unknown numbers, because the block's end may already be on its way.
  void cancel(LinkId link, std::uint64_t block);
  /// Records thread time that the node spent on a block. Ignores unknown numbers.
  void serve(LinkId link, std::uint64_t block, double cpu_seconds);
  /// Removes a block whose end was sent.
  void remove(LinkId link, std::uint64_t block);
  /// Cancels and removes all blocks of the link.
  void drop(LinkId link);

  /// Returns null if there is none. A block whose link fails `takes_tiles` waits, unless it was cancelled.
  [[nodiscard]] std::shared_ptr<const BlockOrder> next(const TakesTiles& takes_tiles) const;
  /// Returns the thread time that next() may get before a block of another account goes first; infinite if there is no
  /// other account. Ignores those whose links fail `takes_tiles`.
  [[nodiscard]] double seconds_ahead(const TakesTiles& takes_tiles) const;
  [[nodiscard]] std::size_t size() const { return entries_.size(); }

 private:
  using Name = std::pair<LinkId, std::uint64_t>;
  /// Rank on this node's scale, in cpu-microseconds; order of arrival.
  using Turn = std::pair<double, std::uint64_t>;
  struct FlowName {
    std::size_t work = 0;  ///< WorkClass.
    LinkId link = 0;
    std::uint64_t account = 0;
    friend auto operator<=>(const FlowName&, const FlowName&) = default;
  };
  /// Blocks of one class of an account that are still wanted; never empty.
  struct Flow {
    double received = 0.0;  ///< Cpu-microseconds of virtual time, on this node's scale.
    std::map<Turn, std::shared_ptr<BlockOrder>> waiting{};
    [[nodiscard]] Turn turn() const;
  };
  struct Entry {
    FlowName flow;
    Turn turn;
    std::shared_ptr<BlockOrder> order;
  };
  /// A class of work of a link.
  struct Lane {
    std::size_t blocks = 0;
    double shift = 0.0;  ///< Offset from the coordinator's ranks to this node's scale, while there are blocks.
  };
  using Flows = std::map<FlowName, Flow>;

  [[nodiscard]] Flows::const_iterator first(const TakesTiles& takes_tiles) const;
  /// Counts what a block's coordinator states that others of its accounts have received from the whole farm.
  void take_service(const wire::RenderBlock& block, LinkId link);
  /// Removes a block from its flow, if it is there.
  void leave_flow(const Entry& entry);

  std::map<Name, Entry> entries_;
  Flows flows_;
  std::map<std::uint64_t, std::shared_ptr<BlockOrder>> cancelled_;  ///< Keyed by arrival.
  std::map<LinkId, std::array<Lane, kWorkClasses>> lanes_;
  std::array<double, kWorkClasses> now_{};  ///< The latest position that was served, of each class.
  std::uint64_t arrivals_ = 0;
};

}  // namespace cyclorama::node
