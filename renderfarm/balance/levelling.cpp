// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/balance/levelling.h"

#include <algorithm>
#include <optional>
#include <set>

namespace cyclorama::balance {

std::vector<Move> level(std::span<const NodeQueue> nodes, double min_gain_seconds) {
  std::vector<Move> moves;
  std::vector<double> loads;
  std::set<std::pair<double, std::size_t>> by_load;
  std::vector<std::vector<bool>> moved(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    loads.push_back(nodes[i].remaining_seconds());
    by_load.emplace(loads.back(), i);
    moved[i].resize(nodes[i].blocks.size());
  }
  while (by_load.size() > 1) {
    const std::size_t to = by_load.begin()->second;
    const std::size_t from = by_load.rbegin()->second;
    std::optional<std::size_t> best;
    double min = loads[from] - min_gain_seconds;
    for (std::size_t b = 0; b < nodes[from].blocks.size(); ++b) {
      const QueuedBlock& block = nodes[from].blocks[b];
      if (!block.stealable || moved[from][b]) continue;
      const double later =
          std::max(loads[from] - block.work / nodes[from].speed, loads[to] + block.work / nodes[to].speed);
      if (later > min) continue;
      min = later;
      best = b;
    }
    if (!best) break;
    const auto reload = [&](std::size_t node, double by) {
      by_load.erase({loads[node], node});
      loads[node] += by;
      by_load.emplace(loads[node], node);
    };
    const double work = nodes[from].blocks[*best].work;
    reload(from, -work / nodes[from].speed);
    reload(to, work / nodes[to].speed);
    moved[from][*best] = true;
    moves.push_back({from, *best, to});
  }
  return moves;
}

}  // namespace cyclorama::balance
