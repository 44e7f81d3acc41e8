// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/fair_share.h"

#include <algorithm>

#include "common/wire/rank.h"

namespace cyclorama::coordinator {

double FairShare::start(Flow& flow, double cost) {
  const double start = std::max(now_, flow.finish);
  flow.finish = start + cost / flow.weight;
  return start;
}

void FairShare::served(double start) { now_ = std::max(now_, start); }

std::uint64_t FairShare::rank_of(double start, bool at_rest) {
  constexpr double kPerSecond = 1e6;
  constexpr double kMaxScaledStart = 4e18;  // Below kRankAtRest; a hundred thousand years of cpu time.
  return static_cast<std::uint64_t>(std::clamp(start * kPerSecond, 0.0, kMaxScaledStart)) + (at_rest ? kRankAtRest : 0);
}

}  // namespace cyclorama::coordinator
