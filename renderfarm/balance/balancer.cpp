// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/balance/balancer.h"

#include <algorithm>

#include "renderfarm/balance/cost_map_balancer.h"
#include "renderfarm/balance/tree_balancer.h"

namespace cyclorama::balance {

std::string_view name_of(BalanceStrategy strategy) {
  switch (strategy) {
    case BalanceStrategy::kEqual:
      return "equal";
    case BalanceStrategy::kPbt:
      return "pbt";
    case BalanceStrategy::kPbtLeaves:
      return "pbt-leaves";
    case BalanceStrategy::kCostMap:
      return "cost-map";
    case BalanceStrategy::kCostMapStealing:
      break;
  }
  return "cost-map-stealing";
}

std::optional<BalanceStrategy> balance_strategy_of(std::string_view name) {
  const auto* const found = std::ranges::find(kBalanceStrategies, name, name_of);
  return found == kBalanceStrategies.end() ? std::nullopt : std::optional(*found);
}

std::unique_ptr<Balancer> make_balancer(BalanceStrategy strategy) {
  switch (strategy) {
    case BalanceStrategy::kEqual:
      return make_equal_balancer();
    case BalanceStrategy::kPbt:
      return make_pbt_balancer(1);
    case BalanceStrategy::kPbtLeaves:
      return make_pbt_balancer(kLeavesPerNode);
    case BalanceStrategy::kCostMap:
      return make_cost_map_balancer({.stealing = false});
    case BalanceStrategy::kCostMapStealing:
      break;
  }
  return make_cost_map_balancer({});
}

double balance_efficiency(std::span<const double> loads) {
  double sum = 0.0;
  double largest = 0.0;
  for (const double load : loads) {
    sum += load;
    largest = std::max(largest, load);
  }
  return largest > 0.0 ? sum / (static_cast<double>(loads.size()) * largest) : 1.0;
}

}  // namespace cyclorama::balance
