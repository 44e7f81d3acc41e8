// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "renderfarm/balance/stealing.h"

namespace cyclorama::balance {

/// A block that gains from moving to another node before rendering starts.
struct Move {
  std::size_t from = 0;   ///< Node.
  std::size_t block = 0;  ///< Index into its original queue.
  std::size_t to = 0;
};

/// Moves blocks to balance the nodes, because cuts on a grid cannot be exact. This works like stealing, but in advance:
/// the node with the largest load gives a stealable block to the one with the smallest, as long as this reduces the
/// larger of both loads by at least `min_gain_seconds`. No block moves twice. Reentrant; deterministic.
[[nodiscard]] std::vector<Move> level(std::span<const NodeQueue> nodes, double min_gain_seconds);

}  // namespace cyclorama::balance
