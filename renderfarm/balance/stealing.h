// SPDX-License-Identifier: Apache-2.0
/// Chooses the block that an idle node takes from another node. The coordinator and the simulation share this rule.
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
  double work = 0.0;  ///< See PlannedBlock::predicted_seconds.
  bool stealable = false;
};

/// The unfinished blocks of one node in one frame.
struct NodeQueue {
  double speed = 1.0;                 ///< See SplitRequest::speeds.
  std::vector<QueuedBlock> blocks{};  ///< In rendering order; the first is being rendered and cannot be stolen.
  double elapsed_seconds = 0.0;       ///< Time since the node began the first block.

  /// Returns the predicted time until the node has finished all blocks. If the first block has taken longer than
  /// predicted, the node is assumed to be slower by the same factor for the rest.
  [[nodiscard]] double remaining_seconds() const;
};

struct Steal {
  std::size_t from = 0;   ///< Index of the victim.
  std::size_t block = 0;  ///< Index into the victim's blocks; never 0.
  friend bool operator==(const Steal&, const Steal&) = default;
};

/// Returns the block that node `idle` should take; the queue of `idle` is ignored. Of the nodes from which stealing
/// pays, the victim is the one with the most remaining time. Of its stealable blocks, the one is chosen whose move
/// saves the most time (the last of several). Each steal costs `overhead_seconds`. Returns nothing if no steal saves
/// more than its cost, or if the victim would begin the block before the message arrives. Invalid numbers count as no
/// work or no speed. Reentrant; deterministic.
[[nodiscard]] std::optional<Steal> choose_steal(std::span<const NodeQueue> nodes, std::size_t idle,
                                                double overhead_seconds);

}  // namespace cyclorama::balance
