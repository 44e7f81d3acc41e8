// SPDX-License-Identifier: Apache-2.0
/// Strategies for comparison: equal division, and the prediction binary tree of Cordasco et al. (split_tree.h).
#pragma once

#include <memory>

#include "renderfarm/balance/balancer.h"

namespace cyclorama::balance {

inline constexpr std::size_t kLeavesPerNode = 4;

[[nodiscard]] std::unique_ptr<Balancer> make_equal_balancer();
/// Returns a balancer that assumes that a block's last measured time is evenly distributed over its pixels. With
/// several leaves per node, each node has blocks in several parts of the picture.
[[nodiscard]] std::unique_ptr<Balancer> make_pbt_balancer(std::size_t leaves_per_node);

}  // namespace cyclorama::balance
