// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace cyclorama {

/// A speed that is no number, or none, would make cuts that are none: such nodes count as speed 1, or as hardly any.
[[nodiscard]] std::vector<double> usable_speeds(std::span<const double> speeds);

/// The nodes that are worth their overhead, the fastest ones, in their own order: of 1, 2, ... fastest nodes those that
/// a picture of `work` (seconds at speed 1, parted at will) takes least time with, when each costs
/// `node_overhead_seconds` one after the other and `block_overhead_seconds` beside the others. At most `most` of them;
/// at least one if there is one. Precondition: usable speeds.
[[nodiscard]] std::vector<std::size_t> nodes_that_help(std::span<const double> speeds, double work, std::size_t most,
                                                       double node_overhead_seconds);

}  // namespace cyclorama
