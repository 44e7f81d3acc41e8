// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "renderfarm/balance/work_sums.h"

namespace cyclorama::balance {

/// Returns one rectangle per node; together they tile the picture. At each fork half of the nodes get a part. The cut,
/// in either direction, is the one for which the slowest part two forks further down is expected to be done first.
/// Parts that are much longer than wide count as slightly more work. A node whose part would have no cell gets an empty
/// one. Precondition: speeds above 0. Reentrant.
[[nodiscard]] std::vector<CellRect> cut_for_nodes(const WorkSums& work, std::span<const double> speeds);

/// Divides the rectangle into parts, of which part i has about shares[i] of its work, each cut off along the longer
/// side of the remainder, which avoids slivers. Returns fewer parts than shares if there are too few cells.
/// Precondition: shares above 0.
[[nodiscard]] std::vector<CellRect> cut_by_shares(const WorkSums& work, const CellRect& region,
                                                  std::span<const double> shares);

}  // namespace cyclorama::balance
