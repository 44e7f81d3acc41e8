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
#include <optional>
#include <tuple>
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

/// Chooses the block that a node renders next:
///
///   1. a cancelled block, since only its end remains to be sent;
///   2. a block of the most urgent class of work (common/wire/rank.h): moving pictures, pictures at rest, spare work;
///   3. a block of the account that has received the least service;
///   4. of an account's blocks, the one of the lowest rank; among equals, the one that arrived first.
///
/// The service received by an account starts at the rank of its first block, which its coordinator chose by what the
/// account got from the whole farm, and grows with the service that it really gets here (serve()), whatever its blocks
/// were predicted to cost. So a block that costs a thousand times as much as expected delays nobody, and many sessions
/// of one museum get no more than one. The service that a waiting account receives from other nodes counts as soon as
/// an order for another account states it (RenderBlock.received).
///
/// Ranks of different coordinators are not comparable, since each coordinator counts from its own start. A coordinator
/// that had no block here joins at the current rank, and its ranks continue from there for as long as it has blocks, as
/// start-time fair queueing treats a new session (coordinator/accounts.h). Blocks in work stay in the queue: between two
/// pieces of work next() returns a different block if one precedes it by now. Pure; thread-bound.
class RenderQueue {
 public:
  /// Returns true if a block may be chosen.
  using May = std::function<bool(const BlockOrder&)>;

  /// Queues a block. Returns false if the link already has a block of this number, or too many blocks; its coordinator
  /// then violates the protocol.
  bool add(std::shared_ptr<BlockOrder> order);
  /// Cancels a block. Ignores unknown numbers, because the block's end may already be on its way.
  void cancel(LinkId link, std::uint64_t block);
  /// Records thread time that the node spent on a block. Ignores unknown numbers.
  void serve(LinkId link, std::uint64_t block, double cpu_seconds);
  /// Removes a block whose end was sent.
  void remove(LinkId link, std::uint64_t block);
  /// Cancels and removes all blocks of the link.
  void drop(LinkId link);

  /// Returns the first block that `may` be rendered next; null if there is none.
  [[nodiscard]] std::shared_ptr<const BlockOrder> next(const May& may) const;
  /// Returns true if `one` goes before `other`. A block that is not in the queue, as its link was dropped, goes first,
  /// like a cancelled one.
  [[nodiscard]] bool precedes(const BlockOrder& one, const BlockOrder& other) const;
  /// Returns the thread time that a block may use before one of another account, which `may` be rendered, precedes it;
  /// infinite if there is none.
  [[nodiscard]] double seconds_ahead(const BlockOrder& of, const May& may) const;
  /// Returns false once the block was removed, or its link dropped.
  [[nodiscard]] bool has(const BlockOrder& order) const;
  [[nodiscard]] std::size_t size() const { return entries_.size(); }

 private:
  using Name = std::pair<LinkId, std::uint64_t>;
  /// Rank on this node's scale, in cpu-microseconds, and order of arrival.
  using Turn = std::pair<double, std::uint64_t>;
  struct FlowName {
    std::size_t work = 0;  ///< A WorkClass.
    LinkId link = 0;
    std::uint64_t account = 0;
    friend auto operator<=>(const FlowName&, const FlowName&) = default;
  };
  /// Blocks of one account in one class of work that are not cancelled; never empty.
  struct Flow {
    double received = 0.0;  ///< Received service in cpu-microseconds of virtual time, on this node's scale.
    std::map<Turn, std::shared_ptr<BlockOrder>> waiting{};
    [[nodiscard]] Turn turn() const;
  };
  struct Entry {
    FlowName flow;
    Turn turn;
    std::shared_ptr<BlockOrder> order;
  };
  /// One class of work of one link.
  struct Lane {
    std::size_t blocks = 0;
    double shift = 0.0;  ///< Offset from the coordinator's ranks to this node's scale, constant while there are blocks.
  };
  using Flows = std::map<FlowName, Flow>;

  /// A block's place in the order: the class of its work, its account's turn, and its own.
  using Place = std::tuple<std::size_t, Turn, Turn>;
  /// Returns nothing for a block that is cancelled or not in the queue.
  [[nodiscard]] std::optional<Place> place_of(const BlockOrder& order) const;
  /// Counts what a block's coordinator states that others of its accounts have received from the whole farm.
  void take_service(const wire::RenderBlock& block, LinkId link);
  /// Removes a block from its flow, if it is there.
  void leave_flow(const Entry& entry);

  std::map<Name, Entry> entries_;
  Flows flows_;
  std::map<std::uint64_t, std::shared_ptr<BlockOrder>> cancelled_;  ///< Keyed by order of arrival.
  std::map<LinkId, std::array<Lane, kWorkClasses>> lanes_;
  std::array<double, kWorkClasses> now_{};  ///< Latest rank that was served in each class, on this node's scale.
  std::uint64_t arrivals_ = 0;
};

}  // namespace cyclorama::node
