// SPDX-License-Identifier: Apache-2.0
/// The cost-map strategy: predicts the cost of each cell (cost_map.h), searches for the cuts with which the slowest
/// node is done earliest (cut_search.h), and makes the last part of each node's work stealable (stealing.h).
#pragma once

#include <memory>
#include <vector>

#include "renderfarm/balance/balancer.h"
#include "renderfarm/balance/cost_map.h"

namespace cyclorama::balance {

struct CostMapBalancerOptions {
  bool stealing = true;
  CostMapOptions map{};
  /// Shares of a node's work: first the share that the node keeps, then its stealable pieces, of decreasing size.
  std::vector<double> shares{0.80, 0.10, 0.06, 0.04};
};

[[nodiscard]] std::unique_ptr<Balancer> make_cost_map_balancer(const CostMapBalancerOptions& options);

}  // namespace cyclorama::balance
