// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "renderfarm/balance/stealing.h"

namespace cyclorama::balance {

/// A block that is moved to another node before rendering starts.
struct Move {
  std::size_t from = 0;   ///< Index of the node that gives the block.
  std::size_t block = 0;  ///< Index into the original queue of node `from`.
  std::size_t to = 0;
};

/// Returns moves that improve the balance of the nodes, since cuts on a grid cannot be exact. It is work stealing in
/// advance: the node with the largest load gives a stealable block to the node with the smallest load, as long as this
/// reduces the larger of the two loads by at least `min_gain_seconds`. No block moves twice. Reentrant; deterministic.
[[nodiscard]] std::vector<Move> level(std::span<const NodeQueue> nodes, double min_gain_seconds);

}  // namespace cyclorama::balance
