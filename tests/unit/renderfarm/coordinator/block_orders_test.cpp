// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/block_orders.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/doubles/fake_clock.h"
#include "tests/doubles/recording_delegate.h"

namespace cyclorama::coordinator {
namespace {

constexpr NodeId kNode{1};
constexpr SessionId kSession{7};

/// A node, and a session with one frame of one block that was ordered from it.
class BlockOrdersTest : public testing::Test {
 protected:
  BlockOrdersTest() {
    nodes.add(kNode, clock.now());
    nodes.at(kNode).threads = 4.0;
    accounts.set_threads(4.0);
    Session opened;
    opened.scene = "cave";
    opened.account = accounts.open("museum", {});
    sessions.add(kSession, std::move(opened));
    FrameInFlight& frame = session().frames.emplace_back();
    frame.id = 1;
    frame.threads = 4.0;
    block = order_block();
  }
  Session& session() { return sessions.at(kSession); }
  std::uint64_t order_block() {
    const std::uint64_t number = orders.next_number();
    FrameInFlight& frame = session().frames.front();
    frame.assembly.plan(number, kNode, {0, 0, 16, 16});
    orders.order(kSession, session(), frame, number, kNode, {0, 0, 16, 16});
    return number;
  }
  double charged() { return accounts.charged_seconds(session().account); }
  wire::BlockEnd end_of(double cpu_seconds, const std::string& error = "") const {
    wire::BlockEnd end;
    end.set_block(block);
    end.set_render_cpu_seconds(cpu_seconds);
    end.set_error(error);
    return end;
  }

  FakeClock clock;
  RecordingDelegate delegate;
  NodeTable nodes;
  SessionTable sessions{clock, delegate};
  Accounts accounts;
  BlockOrders orders{nodes, sessions, accounts, clock, delegate};
  std::uint64_t block = 0;
};

TEST_F(BlockOrdersTest, charges_each_block_for_more_than_its_rays) {
  ASSERT_TRUE(orders.end(nodes.at(kNode), end_of(0.01)).has_value());
  EXPECT_DOUBLE_EQ(charged(), 0.01 + BlockOrders::kOverheadSeconds);
  EXPECT_DOUBLE_EQ(session().frames.front().charged_seconds, charged());
  EXPECT_TRUE(nodes.at(kNode).blocks.empty());
  EXPECT_TRUE(nodes.at(kNode).accounts.empty());
}

TEST_F(BlockOrdersTest, charges_a_block_that_was_cancelled_before_it_began) {
  ASSERT_TRUE(orders.end(nodes.at(kNode), end_of(0.0, "cancelled")).has_value());
  EXPECT_DOUBLE_EQ(charged(), BlockOrders::kOverheadSeconds);
}

TEST_F(BlockOrdersTest, charges_nothing_twice_and_no_impossible_times) {
  wire::BlockProgress progress;
  progress.set_block(block);
  for (const double seconds : {0.05, 0.05, 0.02, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    progress.set_render_cpu_seconds(seconds);
    ASSERT_TRUE(orders.progress(nodes.at(kNode), progress));
    EXPECT_DOUBLE_EQ(charged(), 0.05);
  }
  ASSERT_TRUE(orders.end(nodes.at(kNode), end_of(0.06)).has_value());
  EXPECT_DOUBLE_EQ(charged(), 0.06 + BlockOrders::kOverheadSeconds);
}

TEST_F(BlockOrdersTest, knows_whose_blocks_they_are) {
  wire::BlockEnd foreign;
  foreign.set_block(block + 1);
  EXPECT_FALSE(orders.end(nodes.at(kNode), foreign).has_value());
  wire::BlockProgress progress;
  progress.set_block(block + 1);
  EXPECT_FALSE(orders.progress(nodes.at(kNode), progress));
  EXPECT_EQ(charged(), 0.0);
}

TEST_F(BlockOrdersTest, charges_the_account_of_a_session_that_has_ended) {
  const AccountId account = session().account;
  sessions.remove(kSession);
  ASSERT_TRUE(orders.end(nodes.at(kNode), end_of(0.01)).has_value());
  EXPECT_DOUBLE_EQ(accounts.charged_seconds(account), 0.01 + BlockOrders::kOverheadSeconds);
}

TEST_F(BlockOrdersTest, cancels_the_blocks_of_a_frame_that_are_still_at_their_nodes) {
  const std::uint64_t second = order_block();
  FrameInFlight& frame = session().frames.front();
  ASSERT_TRUE(orders.end(nodes.at(kNode), end_of(0.01)).has_value());
  frame.assembly.end(block, end_of(0.01));
  delegate.commands.clear();
  orders.give_up(frame, "late", session());
  ASSERT_EQ(delegate.commands[kNode].size(), 1u);
  EXPECT_EQ(delegate.commands[kNode].front().cancel().block(), second);
  EXPECT_EQ(frame.failure, "late");
  orders.give_up(frame, "another reason", session());
  EXPECT_EQ(frame.failure, "late") << "the first reason counts";
  EXPECT_EQ(delegate.commands[kNode].size(), 1u);
}

}  // namespace
}  // namespace cyclorama::coordinator
