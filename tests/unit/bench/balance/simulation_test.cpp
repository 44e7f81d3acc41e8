// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/balance/simulation.h"

#include <gtest/gtest.h>

#include "tests/bench/balance/replay.h"

namespace cyclorama::balance {
namespace {

/// One cell per entry, side by side.
WorkGrid row(const std::vector<float>& work) {
  WorkGrid grid({16 * static_cast<int>(work.size()), 16});
  std::ranges::copy(work, grid.cells().begin());
  return grid;
}

PlannedBlock block(std::size_t node, int cell, double predicted, bool stealable = false) {
  return {node, {16 * cell, 0, 16, 16}, stealable, predicted};
}

TEST(Simulation, adds_up_a_nodes_work) {
  const WorkGrid work = row({3.0f, 1.0f, 2.0f});
  const SimulatedFarm farm{.speeds = {1.0, 2.0}, .block_overhead_seconds = 0.25};
  const SimulatedFrame frame = simulate(farm, work, std::vector{block(0, 0, 3.0), block(1, 1, 1.0), block(1, 2, 2.0)});
  EXPECT_DOUBLE_EQ(frame.seconds, 3.25);  // The other node: 0.25 + 0.5 + 0.25 + 1.
  EXPECT_DOUBLE_EQ(frame.efficiency(farm.speeds), 6.0 / (3.0 * 3.25));
  ASSERT_EQ(frame.measured.size(), 3u);
  EXPECT_DOUBLE_EQ(frame.measured[0].cpu_seconds, 0.5);  // In the order in which they ended.
  EXPECT_DOUBLE_EQ(frame.measured[0].speed, 2.0);
  EXPECT_EQ(frame.measured[0].cell_cpu_seconds, std::vector{0.5f});
}

TEST(Simulation, sends_orders_one_after_the_other) {
  const WorkGrid work = row({1.0f, 1.0f, 1.0f});
  const SimulatedFarm farm{.speeds = {1.0, 1.0, 1.0}, .node_overhead_seconds = 0.1};
  EXPECT_DOUBLE_EQ(simulate(farm, work, std::vector{block(0, 0, 1), block(1, 1, 1), block(2, 2, 1)}).seconds, 1.3);
}

TEST(Simulation, lets_an_idle_node_steal) {
  const WorkGrid work = row({2.0f, 1.0f, 1.0f});
  SimulatedFarm farm{.speeds = {1.0, 1.0}, .steal_seconds = 0.5};
  const std::vector plan{block(0, 0, 2.0), block(0, 1, 1.0, true), block(1, 2, 1.0)};
  EXPECT_DOUBLE_EQ(simulate(farm, work, plan).seconds, 3.0);
  farm.stealing = true;
  const SimulatedFrame frame = simulate(farm, work, plan);
  EXPECT_DOUBLE_EQ(frame.seconds, 2.5);  // Done at 1, received at 1.5, done again at 2.5.
  EXPECT_EQ(frame.steals, 1u);
  farm.steal_seconds = 1.0;  // 1 + 1 + 1 is no sooner.
  EXPECT_EQ(simulate(farm, work, plan).steals, 0u);
}

TEST(Simulation, lets_a_node_without_any_block_steal_from_the_start) {
  const WorkGrid work = row({2.0f, 2.0f});
  const SimulatedFarm farm{.speeds = {1.0, 1.0}, .steal_seconds = 0.5, .stealing = true};
  EXPECT_DOUBLE_EQ(simulate(farm, work, std::vector{block(0, 0, 2.0), block(0, 1, 2.0, true)}).seconds, 2.5);
}

TEST(Simulation, never_takes_a_block_that_the_victim_began_before_the_order_arrived) {
  // Predicted to take 10, the first takes 1.2: at 1.5 the second is being rendered.
  const WorkGrid work = row({1.2f, 1.0f, 1.0f});
  const SimulatedFarm farm{.speeds = {1.0, 1.0}, .steal_seconds = 0.5, .stealing = true};
  const SimulatedFrame frame =
      simulate(farm, work, std::vector{block(0, 0, 10.0), block(0, 1, 1.0, true), block(1, 2, 1.0)});
  EXPECT_NEAR(frame.seconds, 2.2, 1e-6);
  EXPECT_EQ(frame.steals, 0u);
  EXPECT_EQ(frame.late_steals, 1u);
}

TEST(Simulation, ends_at_once_without_work) {
  const SimulatedFarm farm{.speeds = {1.0}, .stealing = true};
  EXPECT_DOUBLE_EQ(simulate(farm, WorkGrid(), {}).seconds, 0.0);
}

TEST(Simulation, includes_the_cost_of_small_tiles) {
  EXPECT_NEAR(relative_jpeg_bytes({0, 0, 32, 32}), 3.0, 1e-9);
  EXPECT_NEAR(relative_jpeg_bytes({0, 0, 64, 64}), 1.5, 1e-9);
  EXPECT_NEAR(relative_jpeg_bytes({0, 0, 128, 128}), 1.13, 1e-9);
  EXPECT_NEAR(relative_jpeg_bytes({0, 0, 256, 256}), 1.04, 1e-9);
  EXPECT_GT(relative_jpeg_bytes({0, 0, 512, 16}), relative_jpeg_bytes({0, 0, 96, 96}));
}

}  // namespace
}  // namespace cyclorama::balance
