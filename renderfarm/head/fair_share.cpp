// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/head/fair_share.h"

#include <algorithm>

namespace cyclorama {

double FairShare::start(Flow& flow, double cost) {
  const double start = std::max(now_, flow.finish);
  flow.finish = start + cost / flow.weight;
  return start;
}

void FairShare::served(double start) { now_ = std::max(now_, start); }

std::uint64_t FairShare::rank_of(double start, bool at_rest) {
  constexpr double kPerSecond = 1e6;
  constexpr std::uint64_t kAtRest = std::uint64_t{1} << 62;
  constexpr double kLargest = 4e18;  // Below kAtRest: a hundred thousand years of cpu time.
  return static_cast<std::uint64_t>(std::clamp(start * kPerSecond, 0.0, kLargest)) + (at_rest ? kAtRest : 0);
}

}  // namespace cyclorama
