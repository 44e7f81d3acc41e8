// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/block_lanes.h"

#include <gtest/gtest.h>

#include <set>

namespace cyclorama::node {
namespace {

using std::chrono::milliseconds;

class BlockLanesTest : public testing::Test {
 protected:
  std::shared_ptr<BlockOrder> add(std::uint64_t block, std::uint64_t rank, std::uint64_t account = 1, LinkId link = 1) {
    auto order = std::make_shared<BlockOrder>();
    order->link = link;
    order->block.set_block(block);
    order->block.set_rank(rank);
    order->block.set_account(account);
    EXPECT_TRUE(lanes.queue().add(order));
    lanes.update(may);
    return order;
  }
  /// Returns the block that a lane begins; 0 if there is none.
  std::uint64_t begin(std::size_t lane) {
    const auto order = lanes.begin(lane, now, may);
    return order == nullptr ? 0 : order->block.block();
  }
  /// Ends a lane's piece, in which its block received so much service.
  void end(std::size_t lane, double cpu_seconds) {
    const auto order = lanes.lanes()[lane].order;
    lanes.queue().serve(order->link, order->block.block(), cpu_seconds);
    lanes.end(lane, now, cpu_seconds);
    lanes.update(may);
  }

  BlockLanes lanes{2};
  TimePoint now{};
  std::set<LinkId> full;
  RenderQueue::May may = [this](const BlockOrder& order) { return !full.contains(order.link); };
};

TEST_F(BlockLanesTest, gives_each_lane_another_block_in_the_queues_order) {
  add(1, 30);
  add(2, 20);
  add(3, 10);
  EXPECT_EQ(begin(1), 3u);
  EXPECT_EQ(begin(0), 2u);
  EXPECT_EQ(lanes.lanes()[1].place, 0u);
  EXPECT_EQ(lanes.lanes()[0].place, 1u);
  end(1, 0.0);
  EXPECT_EQ(begin(1), 3u) << "it is not done";
  lanes.queue().remove(1, 3);
  end(0, 0.0);
  EXPECT_EQ(begin(0), 2u);
}

TEST_F(BlockLanesTest, lets_the_last_give_way_only_when_no_lane_is_free) {
  add(1, 30);
  EXPECT_EQ(begin(0), 1u);
  add(2, 10);
  EXPECT_FALSE(lanes.lanes()[0].is_preempted) << "the other lane is free";
  EXPECT_EQ(begin(1), 2u);
  EXPECT_EQ(lanes.lanes()[1].place, 0u) << "it gets the threads";
  add(3, 40);
  EXPECT_FALSE(lanes.lanes()[0].is_preempted) << "it goes after both";
  add(4, 20);
  EXPECT_TRUE(lanes.lanes()[0].is_preempted);
  EXPECT_FALSE(lanes.lanes()[1].is_preempted);
  end(0, 0.0);
  EXPECT_EQ(begin(0), 4u);
}

TEST_F(BlockLanesTest, ends_cancelled_blocks_first_and_leaves_out_links_that_take_nothing) {
  full = {2};
  add(1, 1, 1, 2);
  add(2, 2);
  EXPECT_EQ(begin(0), 2u);
  EXPECT_EQ(begin(1), 0u);
  lanes.queue().cancel(2, 1);
  EXPECT_EQ(begin(1), 1u) << "only its end is to be sent";
}

TEST_F(BlockLanesTest, ends_a_piece_when_its_account_has_received_as_much_as_one_that_waits) {
  add(1, 0, 1);
  begin(0);
  EXPECT_EQ(lanes.lanes()[0].ends_at, now + milliseconds(50)) << "nobody else waits; progress is reported";
  add(2, 20'000, 2);
  EXPECT_EQ(lanes.lanes()[0].ends_at, now + milliseconds(20)) << "on one thread";
  now += milliseconds(20);
  end(0, 0.1);
  EXPECT_EQ(begin(0), 2u) << "the other account has received less by now";
  begin(1);
  EXPECT_EQ(lanes.lanes()[1].order->block.block(), 1u);
  EXPECT_EQ(lanes.lanes()[0].place, 0u);
  EXPECT_LT(lanes.lanes()[0].ends_at, now + milliseconds(50)) << "the account in the other lane is ahead by 80 ms";
}

TEST_F(BlockLanesTest, takes_a_dropped_links_block_for_a_cancelled_one) {
  add(1, 10, 1, 2);
  begin(0);
  lanes.queue().drop(2);
  add(2, 1);
  begin(1);
  EXPECT_EQ(lanes.lanes()[0].place, 0u);
  add(3, 0);
  EXPECT_FALSE(lanes.lanes()[0].is_preempted);
  EXPECT_TRUE(lanes.lanes()[1].is_preempted);
}

TEST(LanesFor, are_one_for_one_thread_and_more_for_more) {
  EXPECT_EQ(lanes_for(1), 1u);
  EXPECT_GT(lanes_for(2), 1u);
  EXPECT_GE(lanes_for(128), lanes_for(2));
}

}  // namespace
}  // namespace cyclorama::node
