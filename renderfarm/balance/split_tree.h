// SPDX-License-Identifier: Apache-2.0
/// The binary tree that cuts a picture into one block per node.
#pragma once

#include <span>
#include <vector>

#include "common/image/pixel_rect.h"
#include "renderfarm/balance/cost_field.h"

namespace cyclorama {

/// A balanced binary tree over the nodes, with a direction of cut at each fork. Splitting moves the cuts so that at
/// every fork the cost to the left is to the cost to the right as the speeds of their nodes are; cuts are at multiples
/// of kCutPx. A fork keeps its direction from frame to frame while the region's shape allows, so that blocks do not
/// jump about.
///
/// Source: Cordasco, Cosenza, De Chiara, Erra, Scarano, "Experiences with mesh-like computations using prediction
/// binary trees", 2009. Thread-bound.
class SplitTree {
 public:
  explicit SplitTree(std::size_t nodes) : cut_across_(2 * nodes, Direction::kUnset) {}

  /// One rectangle per entry of `speeds` (all above 0), which together tile the picture exactly. Empty ones where the
  /// picture has fewer cells of kCutPx than there are nodes. Precondition: as many speeds as nodes.
  std::vector<PixelRect> split(PictureSize size, const CostField& cost, std::span<const double> speeds);

 private:
  enum class Direction : unsigned char { kUnset, kAcross, kDown };
  struct Region;
  void split(Region region, const CostField& cost, std::span<const double> speeds, std::size_t fork,
             std::span<PixelRect> ret_blocks);
  Direction direction_for(const Region& region, std::size_t fork);

  std::vector<Direction> cut_across_;  ///< By fork, in the order of a walk that goes left first.
};

}  // namespace cyclorama
