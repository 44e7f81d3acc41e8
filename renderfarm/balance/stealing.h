// SPDX-License-Identifier: Apache-2.0
/// Which block a node that has nothing left to do takes from another: the one rule of the head and of the simulation.
///
///     victim   [ being rendered ][ own, next ][ stealable ][ stealable ][st.]
///     idle     done                              └──────▶ takes the one that ends the frame soonest
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace cyclorama {

/// A block of one frame that its node has not ended.
struct QueuedBlock {
  double work = 0.0;  ///< Predicted seconds at speed 1 (PlannedBlock::predicted_seconds).
  bool stealable = false;
};

/// What a node still owes one frame.
struct NodeQueue {
  double speed = 1.0;                 ///< As in SplitRequest.
  std::vector<QueuedBlock> blocks{};  ///< In the order of rendering: the first is under way, and stays where it is.
  double elapsed_seconds = 0.0;       ///< Since the node began the first.

  /// Predicted, until the node is done with all of them. A first block that takes longer than predicted says that the
  /// node is slower than believed, and then so will the rest be.
  [[nodiscard]] double remaining_seconds() const;
};

struct Steal {
  std::size_t from = 0;   ///< Index into the nodes.
  std::size_t block = 0;  ///< Index into its blocks; never 0.
  friend bool operator==(const Steal&, const Steal&) = default;
};

/// What node `idle`, whose own queue does not matter, is to take: from the node with the most left to do, the stealable
/// block whose going there ends their part of the frame soonest (of equals the last). Each steal costs
/// `overhead_seconds` on the way; nothing where no steal gains more than that, or where the victim would have begun
/// before the word reached it. Numbers that are none count as no work, or as no speed. Reentrant; deterministic.
[[nodiscard]] std::optional<Steal> choose_steal(std::span<const NodeQueue> nodes, std::size_t idle,
                                                double overhead_seconds);

}  // namespace cyclorama
