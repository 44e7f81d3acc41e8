// SPDX-License-Identifier: Apache-2.0
/// Ours: a map of what each cell costs (cost_map.h), cut where the slowest node is done first (cut_search.h), and the
/// last of each node's work in pieces that others may take (stealing.h).
#pragma once

#include <memory>
#include <vector>

#include "renderfarm/balance/balancer.h"
#include "renderfarm/balance/cost_map.h"

namespace cyclorama {

struct CostMapBalancerOptions {
  bool stealing = true;
  CostMapOptions map{};
  /// A node's work: first what stays its own, then its pieces, ever smaller.
  std::vector<double> shares{0.80, 0.10, 0.06, 0.04};
};

[[nodiscard]] std::unique_ptr<Balancer> make_cost_map_balancer(const CostMapBalancerOptions& options);

}  // namespace cyclorama
