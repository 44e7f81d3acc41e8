// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/fair_share.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <limits>

namespace cyclorama::coordinator {
namespace {

/// Always serves the lowest start; a flow has its next frame ready while `wants` is true. Returns the cost served.
template <std::size_t N, typename Wants>
std::array<double, N> served_cost(std::array<FairShare::Flow, N> flows, const std::array<double, N>& costs, int frames,
                                  Wants wants) {
  FairShare share;
  std::array<double, N> done{};
  std::array<double, N> next{};
  std::array<bool, N> ready{};
  for (int frame = 0; frame < frames; ++frame) {
    std::size_t best = N;
    for (std::size_t i = 0; i < N; ++i) {
      if (!ready[i] && wants(i, frame)) {
        next[i] = share.start(flows[i], costs[i]);
        ready[i] = true;
      }
      if (ready[i] && (best == N || next[i] < next[best])) best = i;
    }
    if (best == N) continue;
    share.served(next[best]);
    ready[best] = false;
    done[best] += costs[best];
  }
  return done;
}

TEST(FairShare, gives_processor_time_by_weight_whatever_a_frame_costs) {
  const auto done = served_cost<3>({{{1.0}, {2.0}, {4.0}}}, {0.5, 0.01, 0.1}, 20000, [](auto, auto) { return true; });
  EXPECT_NEAR(done[1] / done[0], 2.0, 0.05);
  EXPECT_NEAR(done[2] / done[0], 4.0, 0.05);
}

TEST(FairShare, gives_no_credit_for_absence) {
  // The second flow joins after a long absence: from then on both get half.
  const auto done =
      served_cost<2>({}, {1.0, 1.0}, 2000, [](std::size_t i, int frame) { return i == 0 || frame > 1000; });
  EXPECT_NEAR(done[0], 1500.0, 3.0);
  EXPECT_NEAR(done[1], 500.0, 3.0);
}

TEST(FairShare, ranks_refinements_behind_all_moving_pictures) {
  EXPECT_LT(FairShare::rank_of(1e12, false), FairShare::rank_of(0.0, true));
  EXPECT_LT(FairShare::rank_of(1.0, true), FairShare::rank_of(2.0, true));
  EXPECT_LT(FairShare::rank_of(1e300, false), FairShare::rank_of(0.0, true));
  EXPECT_LT(FairShare::rank_of(std::numeric_limits<double>::infinity(), false), FairShare::rank_of(0.0, true));
}

}  // namespace
}  // namespace cyclorama::coordinator
