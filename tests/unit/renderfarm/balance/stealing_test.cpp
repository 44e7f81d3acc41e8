// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/balance/stealing.h"

#include <gtest/gtest.h>

#include <limits>

namespace cyclorama::balance {
namespace {

using Nodes = std::vector<NodeQueue>;

NodeQueue queue(double speed, double first, std::vector<double> stealable, double elapsed = 0.0) {
  NodeQueue node{speed, {{first, false}}, elapsed};
  for (const double work : stealable) node.blocks.push_back({work, true});
  return node;
}

const NodeQueue kDone{1.0, {}, 0.0};

TEST(Stealing, takes_from_the_node_with_the_most_remaining_time) {
  const Nodes nodes{kDone, queue(1, 1, {0.5}), queue(1, 2, {0.5}), queue(1, 1.5, {0.5})};
  EXPECT_EQ(choose_steal(nodes, 0, 0.0), (Steal{2, 1}));
}

TEST(Stealing, compares_remaining_time_rather_than_work) {
  const Nodes nodes{kDone, queue(1, 1, {0.5}), queue(4, 2, {0.5})};  // 1.5 s and 0.625 s remain.
  EXPECT_EQ(choose_steal(nodes, 0, 0.0), (Steal{1, 1}));
}

TEST(Stealing, takes_the_last_of_equal_blocks) {
  const Nodes nodes{queue(1, 3, {0.5, 0.5, 0.5}), kDone};
  EXPECT_EQ(choose_steal(nodes, 1, 0.0), (Steal{0, 3}));
}

TEST(Stealing, takes_the_block_that_ends_the_frame_earliest) {
  // Five seconds remain. Alone the victim ends at 5; without the 2 at 3 (and the thief at 2); without the 1 at 4.
  const Nodes nodes{queue(1, 2, {2, 1}), kDone};
  EXPECT_EQ(choose_steal(nodes, 1, 0.0), (Steal{0, 1}));
  // A node ten times slower would take 20 seconds for the 2, and two for the 0.2, which is before the victim's 4.
  const Nodes slow{queue(1, 2, {2, 0.2}), {0.1, {}, 0.0}};
  EXPECT_EQ(choose_steal(slow, 1, 0.0), (Steal{0, 2}));
}

TEST(Stealing, never_takes_a_block_in_progress_or_one_that_is_not_stealable) {
  EXPECT_EQ(choose_steal(Nodes{{1.0, {{9.0, true}}, 0.0}, kDone}, 1, 0.0), std::nullopt);
  EXPECT_EQ(choose_steal(Nodes{{1.0, {{9.0, true}, {9.0, false}}, 0.0}, kDone}, 1, 0.0), std::nullopt);
  EXPECT_EQ(choose_steal(Nodes{{1.0, {{9.0, true}, {9.0, false}, {1.0, true}}, 0.0}, kDone}, 1, 0.0), (Steal{0, 2}));
}

TEST(Stealing, takes_from_the_next_node_if_the_first_has_nothing_stealable) {
  const Nodes nodes{{1.0, {{9.0, false}}, 0.0}, queue(1, 1, {0.5}), kDone};
  EXPECT_EQ(choose_steal(nodes, 2, 0.0), (Steal{1, 1}));
}

TEST(Stealing, takes_nothing_that_would_not_be_done_sooner) {
  // 0.8 s remain; stolen, it would be done after the overhead and 0.3 s.
  const Nodes nodes{queue(1, 0.5, {0.3}), kDone};
  EXPECT_TRUE(choose_steal(nodes, 1, 0.4));
  EXPECT_FALSE(choose_steal(nodes, 1, 0.5));
  EXPECT_FALSE(choose_steal(Nodes{queue(1, 0.5, {0.3}), {0.3, {}, 0.0}}, 1, 0.0));
}

TEST(Stealing, takes_nothing_that_the_victim_would_have_begun) {
  EXPECT_EQ(choose_steal(Nodes{queue(1, 1, {2, 1}, 0.99), kDone}, 1, 0.1), (Steal{0, 2}));
  EXPECT_EQ(choose_steal(Nodes{queue(1, 1, {1}, 0.99), kDone}, 1, 0.1), std::nullopt);
}

TEST(Stealing, detects_that_a_node_is_slower_than_predicted) {
  // Both should have the same remaining time, but the second's first block has taken ten times its prediction.
  const Nodes nodes{queue(1, 1, {1, 1}), queue(1, 0.1, {1, 0.9}, 1.0), kDone};
  EXPECT_DOUBLE_EQ(nodes[0].remaining_seconds(), 3.0);
  EXPECT_DOUBLE_EQ(nodes[1].remaining_seconds(), 19.0);
  EXPECT_EQ(choose_steal(nodes, 2, 0.0)->from, 1u);
}

TEST(Stealing, accounts_for_progress_in_the_first_block) {
  EXPECT_DOUBLE_EQ(queue(2, 1, {1}, 0.25).remaining_seconds(), 0.75);
  EXPECT_DOUBLE_EQ(kDone.remaining_seconds(), 0.0);
}

TEST(Stealing, survives_invalid_numbers) {
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity(), 1e308, 5e-324}) {
    const Nodes nodes{queue(bad, 1, {bad, 1}, bad), queue(1, bad, {1, bad}, bad), {bad, {}, 0.0}, kDone};
    for (std::size_t idle = 0; idle < 5; ++idle) {
      const auto steal = choose_steal(nodes, idle, bad);
      if (!steal) continue;
      ASSERT_LT(steal->from, nodes.size());
      ASSERT_NE(steal->from, idle);
      ASSERT_LT(steal->block, nodes[steal->from].blocks.size());
      ASSERT_GT(steal->block, 0u);
    }
  }
}

}  // namespace
}  // namespace cyclorama::balance
