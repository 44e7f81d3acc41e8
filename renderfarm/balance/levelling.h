// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "renderfarm/balance/stealing.h"

namespace cyclorama {

/// A block that is worth more elsewhere before anything is rendered.
struct Move {
  std::size_t from = 0;   ///< Node.
  std::size_t block = 0;  ///< Index into its queue as it was given.
  std::size_t to = 0;
};

/// Cuts lie on a grid, so no cut gives every node the same. As a steal would, but beforehand: the node with the most to
/// do gives a stealable block to the one with the least, for as long as that brings the frame's end at least
/// `worth_seconds` nearer. No block moves twice. Reentrant; deterministic.
[[nodiscard]] std::vector<Move> level(std::span<const NodeQueue> nodes, double worth_seconds);

}  // namespace cyclorama
