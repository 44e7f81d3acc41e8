// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace cyclorama::balance {

/// Replaces invalid speeds, which would yield invalid cuts: a speed that is not finite becomes 1, and others are
/// clamped to [1e-6, 1e12].
[[nodiscard]] std::vector<double> usable_speeds(std::span<const double> speeds);

/// Returns the nodes whose use outweighs their overhead, fastest first. Of the sets of the 1, 2, ... fastest nodes,
/// this is the one that takes the least time for a picture of `work` (seconds at speed 1, arbitrarily divisible) if
/// each node costs `node_overhead_seconds` serially. Returns at most `max` nodes, and at least one if there are any.
/// Precondition: the speeds are those of usable_speeds().
[[nodiscard]] std::vector<std::size_t> nodes_that_help(std::span<const double> speeds, double work, std::size_t max,
                                                       double node_overhead_seconds);

}  // namespace cyclorama::balance
