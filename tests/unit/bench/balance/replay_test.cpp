// SPDX-License-Identifier: Apache-2.0
// Strengths of each strategy, on synthetic frames.
#include "tests/bench/balance/replay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace cyclorama::balance {
namespace {

constexpr PictureSize kSize{960, 540};

using Density = std::function<double(double x, double y)>;  ///< At a position in fractions of the picture.

/// A relic before an empty background: a tenth of the picture has most of the cost.
double relic(double x, double y) {
  const double r2 = (x - 0.4) * (x - 0.4) * 9.0 + (y - 0.5) * (y - 0.5) * 4.0;
  return 0.1 + 4.0 * std::exp(-6.0 * r2);
}
double wall(double x, double y) { return 1.0 + 0.6 * std::sin(9.0 * x) * std::cos(7.0 * y) + 0.8 * x; }

RecordedFrame frame(const Density& density, double heading_rad = 0.0, PictureSize size = kSize) {
  RecordedFrame out{WorkGrid(size), heading_rad, 1.5};
  for (int y = 0; y < out.work.rows(); ++y) {
    for (int x = 0; x < out.work.columns(); ++x) {
      const double area = double(out.work.width_px(x)) * out.work.height_px(y);
      out.work.at(x, y) =
          static_cast<float>(1e-6 * area * density((x + 0.5) / out.work.columns(), (y + 0.5) / out.work.rows()));
    }
  }
  return out;
}

std::vector<ReplayedFrame> replayed(const std::vector<RecordedFrame>& frames, BalanceStrategy strategy,
                                    SimulatedFarm farm) {
  farm.stealing = strategy == BalanceStrategy::kCostMapStealing;
  return replay(frames, {.farm = std::move(farm)}, [&] { return make_balancer(strategy); });
}

SimulatedFarm farm_of(std::size_t nodes) {
  return {.speeds = std::vector(nodes, 1.0),
          .steal_seconds = 3e-4,
          .block_overhead_seconds = 5e-5,
          .node_overhead_seconds = 2e-5};
}

double mean_efficiency(const std::vector<ReplayedFrame>& frames) {
  double sum = 0.0;
  for (const ReplayedFrame& f : frames) sum += f.efficiency;
  return sum / static_cast<double>(frames.size());
}

std::vector<RecordedFrame> walking_past(const Density& density, int frames) {
  std::vector<RecordedFrame> out;
  for (int i = 0; i < frames; ++i) {
    out.push_back(frame([&](double x, double y) { return density(x + 0.2 * std::sin(0.1 * i), y); }));
  }
  return out;
}

TEST(Replay, shows_each_strategy_better_than_the_simpler_one) {
  for (const Density& density : {Density(relic), Density(wall)}) {
    const auto frames = walking_past(density, 30);
    const double equal = mean_efficiency(replayed(frames, BalanceStrategy::kEqual, farm_of(16)));
    const double pbt = mean_efficiency(replayed(frames, BalanceStrategy::kPbt, farm_of(16)));
    const double ours = mean_efficiency(replayed(frames, BalanceStrategy::kCostMapStealing, farm_of(16)));
    EXPECT_GT(pbt, 1.1 * equal);
    EXPECT_GT(ours, pbt + 0.02);
    EXPECT_GT(ours, 0.88);
  }
}

TEST(Replay, shows_our_strategy_never_below_equal_division) {
  for (const std::size_t nodes : {2u, 5u, 16u, 64u, 200u}) {
    const auto frames = walking_past(relic, 30);
    const auto equal = replayed(frames, BalanceStrategy::kEqual, farm_of(nodes));
    const auto ours = replayed(frames, BalanceStrategy::kCostMapStealing, farm_of(nodes));
    for (std::size_t i = 0; i < ours.size(); ++i) EXPECT_LE(ours[i].seconds, equal[i].seconds) << nodes << " nodes";
  }
}

TEST(Replay, has_an_oracle_that_no_strategy_beats_by_much) {
  const auto frames = walking_past(wall, 20);
  SimulatedFarm farm = farm_of(16);
  const ReplayOptions options{.farm = farm, .oracle = true};
  const auto oracle = replay(frames, options, [] { return make_balancer(BalanceStrategy::kCostMap); });
  EXPECT_GT(mean_efficiency(oracle), mean_efficiency(replayed(frames, BalanceStrategy::kCostMap, farm)) - 0.005);
}

/// Returns the worst ratio of a frame's time to the best time with fewer nodes.
double worst_step(double node_overhead_seconds, bool stealing) {
  const std::vector<RecordedFrame> frames(3, frame(relic));
  double min = 1e9;
  double worst = 0.0;
  for (std::size_t nodes = 1; nodes <= 80; ++nodes) {
    SimulatedFarm farm = farm_of(nodes);
    farm.node_overhead_seconds = node_overhead_seconds;
    farm.stealing = stealing;
    const auto replayed_frames =
        replay(frames, {.farm = farm}, [] { return make_balancer(BalanceStrategy::kCostMapStealing); });
    const double seconds = replayed_frames.back().seconds;
    worst = std::max(worst, seconds / min);
    min = std::min(min, seconds);
  }
  return worst;
}

TEST(Replay, is_never_slower_with_one_more_node) {
  for (const double node_overhead_seconds : {2e-5, 1e-3}) {
    EXPECT_LE(worst_step(node_overhead_seconds, false), 1.0001);
    // Each steal is decided when it occurs, so the frame's time need not be the optimum.
    EXPECT_LE(worst_step(node_overhead_seconds, true), 1.02);
  }
}

TEST(Replay, uses_unequal_nodes_according_to_their_speed) {
  const auto frames = walking_past(wall, 20);
  SimulatedFarm farm = farm_of(8);
  farm.speeds = {1.0, 4.0, 1.0, 2.0, 0.25, 1.0, 0.5, 3.0};
  EXPECT_GT(mean_efficiency(replayed(frames, BalanceStrategy::kCostMapStealing, farm)), 0.95);
  EXPECT_GT(mean_efficiency(replayed(frames, BalanceStrategy::kCostMap, farm)), 0.9);
}

TEST(Replay, moves_the_costs_with_the_turning_eye) {
  // The picture spans 1.5 rad; its content moves left as far as the eye turns right.
  const auto turning = [](bool told) {
    std::vector<RecordedFrame> out;
    for (int i = 0; i < 20; ++i) {
      const double heading = 0.06 * i;
      out.push_back(frame([&](double x, double y) { return relic(x + heading / 1.5 - 0.4, y); }, told ? heading : 0.0));
    }
    return out;
  };
  const double told = mean_efficiency(replayed(turning(true), BalanceStrategy::kCostMap, farm_of(8)));
  const double untold = mean_efficiency(replayed(turning(false), BalanceStrategy::kCostMap, farm_of(8)));
  EXPECT_GT(told, untold + 0.05);
}

TEST(Replay, continues_when_the_picture_changes_its_size) {
  std::vector<RecordedFrame> frames;
  for (int i = 0; i < 12; ++i) frames.push_back(frame(wall, 0.0, i % 2 == 0 ? kSize : PictureSize{640, 368}));
  EXPECT_GT(mean_efficiency(replayed(frames, BalanceStrategy::kCostMapStealing, farm_of(8))), 0.94);
}

TEST(Replay, tolerates_noise_in_the_timers) {
  ReplayOptions options{.farm = farm_of(16), .timer_noise = 0.3};
  options.farm.stealing = true;
  const auto frames = walking_past(wall, 20);
  EXPECT_GT(mean_efficiency(replay(frames, options, [] { return make_balancer(BalanceStrategy::kCostMapStealing); })),
            0.9);
}

TEST(Replay, is_deterministic) {
  const auto frames = walking_past(relic, 5);
  const auto one = replayed(frames, BalanceStrategy::kCostMapStealing, farm_of(16));
  const auto two = replayed(frames, BalanceStrategy::kCostMapStealing, farm_of(16));
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].seconds, two[i].seconds);
}

}  // namespace
}  // namespace cyclorama::balance
