// SPDX-License-Identifier: Apache-2.0
/// Chooses the block that an idle node takes from another; the coordinator and the simulation share this rule.
///
///     victim   [ being rendered ][ own, next ][ stealable ][ stealable ][st.]
///     idle     done                              └──────▶ takes the one that ends the frame soonest
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace cyclorama::balance {

/// A block of one frame that its node has not finished.
struct QueuedBlock {
  double work = 0.0;  ///< Predicted seconds at speed 1 (PlannedBlock::predicted_seconds).
  bool stealable = false;
};

/// Unfinished blocks of one node in one frame.
struct NodeQueue {
  double speed = 1.0;                 ///< Same meaning as in SplitRequest.
  std::vector<QueuedBlock> blocks{};  ///< In rendering order; the first is being rendered and cannot be stolen.
  double elapsed_seconds = 0.0;       ///< Time since the node began the first block.

  /// Returns the predicted time until the node has finished all of them. A first block that takes longer than predicted
  /// indicates that the node is slower than assumed, which then applies to the rest.
  [[nodiscard]] double remaining_seconds() const;
};

struct Steal {
  std::size_t from = 0;   ///< Index into the nodes.
  std::size_t block = 0;  ///< Index into its blocks; never 0.
  friend bool operator==(const Steal&, const Steal&) = default;
};

/// Returns the block that node `idle` should take; its own queue is ignored. The victim is the node with the most
/// remaining work, and the block is the stealable one whose move ends their part of the frame soonest (the last of
/// equals). Each steal costs `overhead_seconds`. Null if no steal gains more than that, or if the victim would begin
/// the block before the message arrives. Invalid numbers count as no work or no speed. Reentrant; deterministic.
[[nodiscard]] std::optional<Steal> choose_steal(std::span<const NodeQueue> nodes, std::size_t idle,
                                                double overhead_seconds);

}  // namespace cyclorama::balance
