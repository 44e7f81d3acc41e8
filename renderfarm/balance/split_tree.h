// SPDX-License-Identifier: Apache-2.0
/// The binary tree that divides a picture into one block per leaf.
#pragma once

#include <span>
#include <vector>

#include "renderfarm/balance/work_sums.h"

namespace cyclorama::balance {

/// A balanced binary tree over the leaves, with a direction of cut at each fork. split() places each cut such that the
/// work is divided in proportion to the speeds of the leaves on its sides. A fork keeps its direction from frame to
/// frame as long as the region's shape allows it, so that blocks stay in place.
///
/// Source: Cordasco, Cosenza, De Chiara, Erra, Scarano, "Experiences with mesh-like computations using prediction
/// binary trees", 2009. Thread-bound.
class SplitTree {
 public:
  explicit SplitTree(std::size_t leaves) : cuts_(2 * leaves) {}

  /// Returns one rectangle per entry of `speeds` (all above 0); together they tile the picture exactly. Some are empty
  /// if the picture has fewer cells than leaves. Precondition: there are as many speeds as leaves.
  std::vector<CellRect> split(const WorkSums& work, std::span<const double> speeds);

 private:
  struct Fork {
    CutDirection direction = CutDirection::kAcross;
    bool is_chosen = false;
  };
  void split(CellRect region, const WorkSums& work, std::span<const double> speeds, std::size_t fork,
             std::span<CellRect> ret_blocks);
  CutDirection direction_for(const CellRect& region, std::size_t fork);

  std::vector<Fork> cuts_;  ///< Forks in depth-first order, left first.
};

}  // namespace cyclorama::balance
