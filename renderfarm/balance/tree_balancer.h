// SPDX-License-Identifier: Apache-2.0
/// What ours is compared with: equal division, and the paper's prediction binary tree.
#pragma once

#include <memory>

#include "renderfarm/balance/balancer.h"

namespace cyclorama {

inline constexpr std::size_t kLeavesPerNode = 4;

[[nodiscard]] std::unique_ptr<Balancer> make_equal_balancer();
/// A block's measured time, evenly over its pixels, until the next is measured; no more is known of what is inside.
/// With several leaves each node has blocks in several parts of the picture.
[[nodiscard]] std::unique_ptr<Balancer> make_pbt_balancer(std::size_t leaves_per_node);

}  // namespace cyclorama
