// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "renderfarm/balance/work_sums.h"

namespace cyclorama {

/// One rectangle per node, which together tile the picture: at each fork half of the nodes get a part, by the cut, in
/// either direction, after which the slowest of the parts two forks on is expected to be done first. Parts that are
/// much longer than wide count as a little more work. A node whose part would have no cell gets an empty one.
/// Precondition: speeds above 0. Reentrant.
[[nodiscard]] std::vector<CellRect> cut_for_nodes(const WorkSums& work, std::span<const double> speeds);

/// The rectangle in parts of which part i has about shares[i] of its work, each cut off along the longer side of what
/// is left, so that none is a sliver. Fewer parts than shares where there are too few cells. Precondition: shares above
/// 0.
[[nodiscard]] std::vector<CellRect> cut_by_shares(const WorkSums& work, const CellRect& region,
                                                  std::span<const double> shares);

}  // namespace cyclorama
