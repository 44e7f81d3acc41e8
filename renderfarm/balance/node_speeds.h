// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace cyclorama::balance {

/// Replaces invalid speeds, which would yield invalid cuts: one that is not finite becomes 1, others are clamped to
/// 1e-6..1e12.
[[nodiscard]] std::vector<double> usable_speeds(std::span<const double> speeds);

/// Returns the nodes that outweigh their overhead, fastest first: of the 1, 2, ... fastest nodes, those that take the
/// least time for a picture of `work` (seconds at speed 1, arbitrarily divisible), if each costs
/// `node_overhead_seconds` serially. At most `max` of them; at least one if there are any. Precondition: usable
/// speeds.
[[nodiscard]] std::vector<std::size_t> nodes_that_help(std::span<const double> speeds, double work, std::size_t max,
                                                       double node_overhead_seconds);

}  // namespace cyclorama::balance
