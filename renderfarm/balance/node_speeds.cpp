// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/balance/node_speeds.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cyclorama::balance {

std::vector<double> usable_speeds(std::span<const double> speeds) {
  std::vector<double> out(speeds.begin(), speeds.end());
  for (double& speed : out) speed = std::isfinite(speed) ? std::clamp(speed, 1e-6, 1e12) : 1.0;
  return out;
}

std::vector<std::size_t> nodes_that_help(std::span<const double> speeds, double work, std::size_t max,
                                         double node_overhead_seconds) {
  std::vector<std::size_t> fastest(speeds.size());
  std::iota(fastest.begin(), fastest.end(), std::size_t{0});
  std::ranges::stable_sort(fastest, std::greater(), [&](std::size_t i) { return speeds[i]; });
  fastest.resize(std::min(max, fastest.size()));
  const double overhead = std::isfinite(node_overhead_seconds) ? std::max(node_overhead_seconds, 0.0) : 0.0;
  double speed = 0.0;
  double min = 0.0;
  std::size_t best = 0;
  for (std::size_t i = 0; i < fastest.size(); ++i) {
    speed += speeds[fastest[i]];
    const double seconds = work / speed + overhead * static_cast<double>(i + 1);
    if (i > 0 && !(seconds < min)) continue;
    min = seconds;
    best = i + 1;
  }
  fastest.resize(best);
  return fastest;
}

}  // namespace cyclorama::balance
