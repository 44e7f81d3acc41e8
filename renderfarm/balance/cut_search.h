// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "renderfarm/balance/work_sums.h"

namespace cyclorama::balance {

/// Returns one rectangle per node; together they tile the picture. Divides recursively: at each fork, each half of the
/// nodes gets a part. Of all cuts in both directions, chooses the one with which the slowest part is expected to be
/// done earliest, looking one fork ahead. Parts that are much longer than wide count as slightly more work. A node gets
/// an empty rectangle if there is no cell for it. Precondition: speeds are above 0. Reentrant.
[[nodiscard]] std::vector<CellRect> cut_for_nodes(const WorkSums& work, std::span<const double> speeds);

/// Divides the rectangle into parts, where part i has about shares[i] of its work. Each part is cut off across the
/// longer side of the remainder, which avoids slivers. Returns fewer parts than shares if there are too few cells.
/// Precondition: shares are above 0.
[[nodiscard]] std::vector<CellRect> cut_by_shares(const WorkSums& work, const CellRect& region,
                                                  std::span<const double> shares);

}  // namespace cyclorama::balance
