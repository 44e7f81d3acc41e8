// SPDX-License-Identifier: Apache-2.0
// Guarantees of every strategy. For their individual strengths see tests/unit/bench/balance/replay_test.cpp.
#include "renderfarm/balance/balancer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <set>

#include "tests/support/block_tiling.h"

namespace cyclorama::balance {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

class EveryBalancer : public testing::TestWithParam<BalanceStrategy> {
 protected:
  std::unique_ptr<Balancer> balancer = make_balancer(GetParam());
};

INSTANTIATE_TEST_SUITE_P(Strategies, EveryBalancer, testing::ValuesIn(kBalanceStrategies), [](const auto& strategy) {
  std::string name(name_of(strategy.param));
  std::ranges::replace(name, '-', '_');
  return name;
});

SplitRequest request(PictureSize size, const std::vector<double>& speeds, double heading_rad = 0.0) {
  return {size, speeds, heading_rad, std::numbers::pi};
}

std::vector<MeasuredBlock> measured(const std::vector<PlannedBlock>& plan, std::mt19937* random, bool reports_cells) {
  std::uniform_real_distribution<double> cost(0.0, 3.0);
  std::vector<MeasuredBlock> out;
  for (const PlannedBlock& block : plan) {
    MeasuredBlock& m = out.emplace_back(MeasuredBlock{block.rect, cost(*random)});
    if (!reports_cells) continue;
    const std::size_t cells = cells_of(block.rect).count();
    for (std::size_t i = 0; i < cells; ++i) {
      m.cell_cpu_seconds.push_back(static_cast<float>(cost(*random) / static_cast<double>(cells)));
    }
  }
  return out;
}

TEST_P(EveryBalancer, tiles_the_picture_exactly_for_1_to_4096_nodes) {
  std::mt19937 random(7);
  std::set<std::size_t> counts{299, 300, 511, 512, 513, 1000, 2047, 2048, 4095, 4096};
  for (std::size_t n = 1; n <= 70; ++n) counts.insert(n);
  for (const PictureSize size : {PictureSize{1920, 1080}, PictureSize{1000, 777}, PictureSize{2048, 160}}) {
    for (const std::size_t n : counts) {
      balancer = make_balancer(GetParam());
      const std::vector<double> speeds(n, 1.0);
      for (int frame = 0; frame < 2; ++frame) {
        const auto plan = balancer->split(request(size, speeds));
        ASSERT_TRUE(is_whole_plan(size, n, plan)) << n << " nodes, " << size.width << "x" << size.height;
        balancer->learn({size, measured(plan, &random, n % 2 == 0)});
      }
    }
  }
}

TEST_P(EveryBalancer, tiles_pictures_of_any_size_even_with_more_nodes_than_cells) {
  std::mt19937 random(7);
  for (const PictureSize size :
       {PictureSize{1, 1}, PictureSize{1, 16384}, PictureSize{16384, 1}, PictureSize{17, 17}, PictureSize{33, 47},
        PictureSize{48, 48}, PictureSize{16, 160}, PictureSize{640, 17}}) {
    for (const std::size_t n : {1u, 2u, 3u, 4u, 7u, 8u, 9u, 16u, 64u, 300u}) {
      balancer = make_balancer(GetParam());
      for (int frame = 0; frame < 2; ++frame) {
        const std::vector<double> speeds(n, 1.0);
        const auto plan = balancer->split(request(size, speeds));
        ASSERT_TRUE(is_whole_plan(size, n, plan)) << n << " nodes, " << size.width << "x" << size.height;
        balancer->learn({size, measured(plan, &random, true)});
      }
    }
  }
}

TEST_P(EveryBalancer, survives_invalid_costs_speeds_and_views) {
  const PictureSize size{1600, 900};
  for (const double bad : {0.0, kNan, kInfinity, -kInfinity, -1.0, 1e308, 5e-324}) {
    for (const bool all : {true, false}) {
      balancer = make_balancer(GetParam());
      for (int frame = 0; frame < 4; ++frame) {
        const std::vector<double> speeds{1.0, all ? bad : 1.0, 2.0, 1.0, bad};
        SplitRequest asked = request(size, speeds, frame == 2 ? bad : 0.0);
        asked.eye_m[1] = frame == 1 ? bad : 1.6;
        asked.azimuth_span_rad = all ? bad : 1.0;
        asked.effort = all ? bad : 1.0;
        asked.block_overhead_seconds = asked.node_overhead_seconds = all ? bad : 0.0;
        const auto plan = balancer->split(asked);
        ASSERT_TRUE(is_whole_plan(size, speeds.size(), plan)) << bad;
        std::vector<MeasuredBlock> blocks;
        for (const PlannedBlock& block : plan) {
          const double seconds = all || blocks.size() == 2 ? bad : 1.0;
          blocks.push_back({block.rect, seconds, std::vector(cells_of(block.rect).count(), static_cast<float>(seconds)),
                            all ? bad : 1.0});
        }
        balancer->learn({size, blocks, all ? bad : 0.0, {bad, 0.0, 0.0}, all ? bad : 1.0});
      }
    }
  }
}

TEST_P(EveryBalancer, survives_blocks_outside_the_picture) {
  const PictureSize size{640, 480};
  const std::vector<double> speeds(4, 1.0);
  const std::vector<MeasuredBlock> blocks{{{-16, 0, 64, 64}, 1.0},   {{0, 0, 64, 4096}, 1.0},
                                          {{8, 8, 64, 64}, 1.0},     {{0, 0, 0, 0}, 1.0},
                                          {{624, 464, 16, 16}, 1.0}, {{32, 32, 2147483647, 16}, 1.0}};
  balancer->learn({size, blocks});
  EXPECT_TRUE(is_whole_plan(size, 4, balancer->split(request(size, speeds))));
  balancer->learn({{0, 0}, blocks});
  balancer->learn({{-5, 7}, blocks});
  EXPECT_TRUE(is_whole_plan(size, 4, balancer->split(request(size, speeds))));
}

TEST_P(EveryBalancer, returns_nothing_without_nodes_or_pixels) {
  const std::vector<double> none;
  const std::vector<double> some(3, 1.0);
  EXPECT_TRUE(balancer->split(request({640, 480}, none)).empty());
  EXPECT_TRUE(balancer->split(request({0, 480}, some)).empty());
  EXPECT_TRUE(balancer->split(request({640, -1}, some)).empty());
}

TEST_P(EveryBalancer, is_deterministic) {
  std::vector<std::vector<PlannedBlock>> plans[2];
  for (auto& of_run : plans) {
    std::mt19937 random(11);
    balancer = make_balancer(GetParam());
    for (int frame = 0; frame < 5; ++frame) {
      const std::vector<double> speeds{1.0, 2.0, 1.0, 4.0, 1.0};
      of_run.push_back(balancer->split(request({800, 448}, speeds, 0.1 * frame)));
      balancer->learn({{800, 448}, measured(of_run.back(), &random, true), 0.1 * frame});
    }
  }
  EXPECT_EQ(plans[0], plans[1]);
}

TEST_P(EveryBalancer, continues_when_nodes_come_and_go_and_the_picture_changes) {
  std::mt19937 random(5);
  for (const auto& [n, size] : {std::pair(4u, PictureSize{800, 448}),
                                {5u, {800, 448}},
                                {3u, {1600, 900}},
                                {64u, {1600, 900}},
                                {1u, {320, 180}},
                                {8u, {17, 4000}}}) {
    const std::vector<double> speeds(n, 1.0);
    for (int frame = 0; frame < 3; ++frame) {
      const auto plan = balancer->split(request(size, speeds));
      ASSERT_TRUE(is_whole_plan(size, n, plan));
      balancer->learn({size, measured(plan, &random, frame != 1)});
    }
  }
}

TEST(BalanceStrategy, has_a_name) {
  for (const BalanceStrategy strategy : kBalanceStrategies) EXPECT_EQ(balance_strategy_of(name_of(strategy)), strategy);
  EXPECT_EQ(balance_strategy_of("best"), std::nullopt);
}

TEST(EqualBalancer, divides_the_area_by_speed) {
  const auto balancer = make_balancer(BalanceStrategy::kEqual);
  const std::vector<double> speeds{1.0, 3.0};
  const auto plan = balancer->split(request({1600, 160}, speeds));
  ASSERT_EQ(plan.size(), 2u);
  EXPECT_EQ(plan[0].rect, (PixelRect{0, 0, 400, 160}));
}

TEST(CostMapStealing, makes_a_few_stealable_pieces_of_decreasing_size) {
  const auto balancer = make_balancer(BalanceStrategy::kCostMapStealing);
  const std::vector<double> speeds(4, 1.0);
  const PictureSize size{1920, 1080};
  const auto plan = balancer->split(request(size, speeds));
  double stealable = 0.0;
  double all = 0.0;
  for (std::size_t i = 0; i < plan.size(); ++i) {
    all += plan[i].predicted_seconds;
    if (!plan[i].stealable) continue;
    stealable += plan[i].predicted_seconds;
    ASSERT_GT(i, 0u);
    if (plan[i - 1].node == plan[i].node) {
      EXPECT_LE(plan[i].predicted_seconds, plan[i - 1].predicted_seconds);
    }
  }
  EXPECT_NEAR(stealable / all, 0.2, 0.03);
  EXPECT_EQ(plan.size(), 16u);
}

TEST(CostMapStealing, makes_no_piece_whose_overhead_exceeds_its_gain) {
  const auto balancer = make_balancer(BalanceStrategy::kCostMapStealing);
  const std::vector<double> speeds(4, 1.0);
  SplitRequest asked = request({640, 352}, speeds);
  asked.block_overhead_seconds = 1.0;
  EXPECT_EQ(balancer->split(asked).size(), 4u);
}

TEST(CostMap, gives_no_work_to_nodes_that_would_make_the_frame_slower) {
  const auto balancer = make_balancer(BalanceStrategy::kCostMap);
  const std::vector<double> speeds(64, 1.0);
  SplitRequest asked = request({640, 352}, speeds);
  asked.node_overhead_seconds = 0.01;
  const std::vector<MeasuredBlock> second{{{0, 0, 640, 352}, 1.0}};
  balancer->learn({{640, 352}, second});
  // One second of work: 1/n + n/100 is minimal for 10 nodes.
  EXPECT_EQ(balancer->split(asked).size(), 10u);
}

TEST(BalanceEfficiency, is_mean_over_maximum) {
  EXPECT_DOUBLE_EQ(balance_efficiency(std::vector<double>{1.0, 1.0, 1.0}), 1.0);
  EXPECT_DOUBLE_EQ(balance_efficiency(std::vector<double>{1.0, 3.0}), 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(balance_efficiency(std::vector<double>{0.0, 0.0, 0.0, 2.0}), 0.25);
  EXPECT_DOUBLE_EQ(balance_efficiency({}), 1.0);
}

}  // namespace
}  // namespace cyclorama::balance
