// SPDX-License-Identifier: Apache-2.0
// Deadlines and turns, and nodes that are slow, silent, draining or short of memory.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "tests/support/farm_simulation.h"

namespace cyclorama::coordinator {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::HasSubstr;

/// A farm with one session whose frames have taken 100 ms for a while.
class CoordinatorFaultsTest : public testing::Test {
 protected:
  void open(int count, double frame_budget_ms = 0.0) {
    for (int i = 0; i < count; ++i) nodes.push_back(s.add_node());
    session = s.add_session(frame_budget_ms);
    drain_opened(s, session);
    for (int i = 0; i < 60; ++i) {
      s.request_view(session, view_of(++number));
      s.clock.advance(100ms);
      s.settle(nodes);
    }
    s.complete = 0;
    ASSERT_EQ(s.given_up, 0);
  }
  /// All other nodes finish all their blocks.
  void settle_without(NodeId one) {
    std::vector<NodeId> others;
    std::ranges::copy_if(nodes, std::back_inserter(others), [&](NodeId node) { return node != one; });
    s.settle(others);
  }
  void pass(Duration time) {
    s.clock.advance(time);
    s.state.tick();
  }
  /// Renders one frame while the first node is slowed by this factor. Returns that node's share in pixels.
  std::int64_t frame(double slowed) {
    s.request_view(session, view_of(++number));
    std::int64_t share = 0;
    for (const auto& block : blocks(s.delegate.commands[nodes[0]])) {
      share += std::int64_t{block.width_px()} * block.height_px();
    }
    s.slowed[nodes[0]] = slowed;
    s.settle(nodes);
    pass(100ms);
    return share;
  }
  static std::vector<wire::RenderBlock> blocks(const std::deque<wire::NodeCommand>& commands) {
    std::vector<wire::RenderBlock> out;
    for (const wire::NodeCommand& command : commands) {
      if (command.has_render()) out.push_back(command.render());
    }
    return out;
  }

  FarmSimulation s;
  std::vector<NodeId> nodes;
  SessionId session{};
  std::uint64_t number = 0;
};

TEST_F(CoordinatorFaultsTest, a_silent_nodes_work_is_shared_by_all_idle_nodes) {
  open(5);
  const NodeId stuck = nodes.front();
  s.request_view(session, view_of(++number));
  const std::size_t owed = blocks(s.delegate.commands[stuck]).size();
  settle_without(stuck);
  EXPECT_EQ(s.complete, 0);
  pass(59ms);
  settle_without(stuck);
  EXPECT_EQ(s.complete, 0);
  EXPECT_LE(s.state.next_deadline() - s.clock.now(), 2ms);
  pass(2ms);
  std::size_t helpers = 0;
  for (const NodeId node : nodes) helpers += node != stuck && !blocks(s.delegate.commands[node]).empty() ? 1u : 0u;
  EXPECT_EQ(helpers, 4u);
  settle_without(stuck);
  EXPECT_EQ(s.complete, 1);
  EXPECT_EQ(s.given_up, 0);
  EXPECT_GE(owed, 1u);
  s.settle(nodes);  // The silent node resumes, but its tiles are no longer wanted.
  EXPECT_EQ(s.complete, 1);
}

TEST_F(CoordinatorFaultsTest, slow_nodes_alone_never_end_a_frame) {
  open(12);
  s.request_view(session, view_of(++number));
  s.settle({nodes.back()});  // All other nodes are silent, including those that the work is reassigned to.
  for (int i = 0; i < 12; ++i) {
    pass(200ms);
    s.settle({nodes.back()});
  }
  EXPECT_EQ(s.given_up, 0);
  EXPECT_EQ(s.complete, 1);
}

TEST_F(CoordinatorFaultsTest, a_node_that_is_repeatedly_late_is_logged_once_in_ten_seconds) {
  open(3);
  const NodeId stuck = nodes.front();
  const auto lines = [&] {
    return std::ranges::count_if(s.delegate.notices, [](const std::string& said) {
      return said.find("keeps a frame waiting") != std::string::npos;
    });
  };
  const auto be_late = [&] {
    s.request_view(session, view_of(++number));
    settle_without(stuck);
    pass(61ms);
    settle_without(stuck);
    s.settle(nodes);
  };
  for (int i = 0; i < 5; ++i) be_late();
  EXPECT_EQ(lines(), 1);
  EXPECT_EQ(s.complete, 5);
  s.clock.advance(10s);
  be_late();
  EXPECT_EQ(lines(), 2);
  EXPECT_THAT(s.delegate.notices.back(), HasSubstr("(4 times more since it was last said)"));
}

TEST_F(CoordinatorFaultsTest, an_idle_node_takes_blocks_that_another_has_not_begun) {
  open(3);
  s.request_view(session, view_of(++number));
  const NodeId busy = nodes[1];
  const std::vector<wire::RenderBlock> owed = blocks(s.delegate.commands[busy]);
  ASSERT_GE(owed.size(), 2u);
  settle_without(busy);
  std::set<std::uint64_t> cancelled;
  for (const wire::NodeCommand& command : s.delegate.commands[busy]) {
    if (command.has_cancel()) cancelled.insert(command.cancel().block());
  }
  // Everything is taken but the current block and blocks too small to be worth moving.
  EXPECT_FALSE(cancelled.contains(owed.front().block()));
  EXPECT_TRUE(cancelled.contains(owed.back().block()));
  EXPECT_EQ(s.complete, 0);
  s.settle(nodes);
  EXPECT_EQ(s.complete, 1);
  EXPECT_GE(s.delegate.frames.back().moved, 1);
  EXPECT_FALSE(s.delegate.frames.back().reassigned);
  EXPECT_FALSE(s.delegate.frames.back().costs.empty());  // Costs of moved blocks are still measured.
}

TEST_F(CoordinatorFaultsTest, nodes_on_shared_hosts_help_each_other_too) {
  constexpr double kShared = 10.0;  // All blocks take ten times as long as forecast, which is usual here.
  open(2);
  for (const NodeId node : nodes) s.slowed[node] = kShared;
  for (int i = 0; i < 30; ++i) {
    s.request_view(session, view_of(++number));
    pass(100ms);
    s.settle(nodes);
  }
  s.request_view(session, view_of(++number));
  const NodeId busy = nodes[1];
  while (blocks(s.delegate.commands[busy]).size() > 2) s.work(busy);
  const std::vector<wire::RenderBlock> left = blocks(s.delegate.commands[busy]);
  ASSERT_EQ(left.size(), 2u);
  pass(5ms);  // Longer than the current block would take on an unshared host, but shorter than it really takes.
  settle_without(busy);
  std::set<std::uint64_t> cancelled;
  for (const wire::NodeCommand& command : s.delegate.commands[busy]) {
    if (command.has_cancel()) cancelled.insert(command.cancel().block());
  }
  EXPECT_TRUE(cancelled.contains(left.back().block()));
  s.settle(nodes);
  EXPECT_EQ(s.delegate.frames.back().moved, 1);
}

TEST_F(CoordinatorFaultsTest, the_next_frame_does_not_wait_for_a_node_that_delayed_the_last) {
  open(4);
  const NodeId stuck = nodes[2];
  s.request_view(session, view_of(++number));
  s.request_view(session, view_of(++number));  // In flight before the fault is detected.
  settle_without(stuck);
  pass(61ms);
  settle_without(stuck);
  EXPECT_EQ(s.complete, 2);
  s.request_view(session, view_of(++number));
  settle_without(stuck);
  EXPECT_EQ(s.complete, 3);  // The stuck node got no block of this frame.
}

TEST_F(CoordinatorFaultsTest, a_node_with_a_block_of_long_expected_time_is_not_silent) {
  open(3);
  s.request_view(session, view_of(++number));
  std::map<NodeId, std::size_t> before;
  for (const NodeId node : nodes) before[node] = blocks(s.delegate.commands[node]).size();
  // No node is idle, so more blocks would not help, however long it takes.
  pass(90ms);
  for (const NodeId node : nodes) EXPECT_EQ(blocks(s.delegate.commands[node]).size(), before[node]);
  s.settle(nodes);
  EXPECT_EQ(s.complete, 1);
}

TEST_F(CoordinatorFaultsTest, a_late_frame_is_abandoned_for_the_next_with_a_reason) {
  open(1);
  s.request_view(session, view_of(++number));
  pass(250ms);
  EXPECT_EQ(s.given_up, 0) << "nothing newer is there to be shown";
  s.request_view(session, view_of(++number));
  pass(1ms);
  while (s.take(session)) {
  }
  EXPECT_EQ(s.given_up, 1);
  EXPECT_TRUE(s.last_end.late());
  EXPECT_THAT(s.last_end.reason(), HasSubstr("late"));
  s.settle(nodes);
  EXPECT_EQ(s.complete, 1);
  EXPECT_FALSE(s.last_end.late());
}

TEST_F(CoordinatorFaultsTest, a_farm_that_misses_every_deadline_still_shows_pictures) {
  open(2, 20.0);
  for (int i = 0; i < 60; ++i) {
    s.request_view(session, view_of(++number));
    s.request_view(session, view_of(++number));
    for (int ms = 0; ms < 900; ms += 10) pass(10ms);
    s.settle(nodes);
  }
  EXPECT_GE(s.complete, 50);
}

TEST_F(CoordinatorFaultsTest, a_draining_node_finishes_its_blocks_and_gets_no_new_ones) {
  open(2);
  s.request_view(session, view_of(++number));
  wire::NodeReport report;
  report.mutable_status()->set_draining(true);
  s.state.node_reported(nodes[0], report);
  s.settle(nodes);
  EXPECT_EQ(s.complete, 1);
  EXPECT_EQ(s.last_end.nodes(), 2u);
  s.request_view(session, view_of(++number));
  EXPECT_TRUE(blocks(s.delegate.commands[nodes[0]]).empty());
  s.settle(nodes);
  EXPECT_EQ(s.complete, 2);
}

TEST_F(CoordinatorFaultsTest, a_slowed_node_gets_less_work_until_it_recovers) {
  open(4);
  const std::int64_t fair = frame(1.0);
  for (int i = 0; i < 20; ++i) frame(10.0);
  EXPECT_LT(frame(10.0), fair / 4);
  for (int i = 0; i < 20; ++i) frame(1.0);
  EXPECT_GT(frame(1.0), fair / 2);
}

TEST_F(CoordinatorFaultsTest, a_node_that_was_too_slow_is_tried_again_with_a_little_work) {
  open(8);
  const std::int64_t fair = frame(1.0);
  for (int i = 0; i < 20; ++i) frame(100.0);
  std::int64_t max = 0;
  int left_out = 0;
  for (int i = 0; i < 100; ++i) {
    const std::int64_t share = frame(100.0);
    max = std::max(max, share);
    left_out += share == 0 ? 1 : 0;
  }
  EXPECT_GT(left_out, 50);
  EXPECT_GT(max, 0);
  EXPECT_LT(max, fair / 4);
  for (int i = 0; i < 100; ++i) frame(1.0);
  EXPECT_GT(frame(1.0), fair / 2);
}

TEST_F(CoordinatorFaultsTest, a_node_that_stalls_now_and_then_counts_as_slow) {
  open(4);
  const std::int64_t fair = frame(1.0);
  const auto stopped = [](int i) { return i % 3 == 0 ? 40.0 : 1.0; };
  for (int i = 0; i < 30; ++i) frame(stopped(i));
  for (int i = 0; i < 30; ++i) EXPECT_LT(frame(stopped(i)), fair / 2) << i;
}

TEST_F(CoordinatorFaultsTest, a_dropped_scene_is_loaded_again_for_the_next_session) {
  open(1);
  wire::NodeReport report;
  report.mutable_scene_dropped()->set_scene("grotto");
  s.state.node_reported(nodes[0], report);
  const SessionId second = s.add_session();
  ASSERT_TRUE(s.delegate.ended_sessions.contains(second));
  EXPECT_THAT(s.delegate.ended_sessions.at(second).message(), HasSubstr("loading"));
  ASSERT_FALSE(s.delegate.commands[nodes[0]].empty());
  const wire::LoadScene& order = s.delegate.commands[nodes[0]].back().load_scene();
  EXPECT_EQ(order.scene(), "grotto");
  EXPECT_EQ(order.in_use_size(), 1);  // The first session's scene.
}

TEST_F(CoordinatorFaultsTest, a_node_that_drops_a_scene_it_never_had_is_disconnected) {
  open(2);
  wire::NodeReport report;
  report.mutable_scene_dropped()->set_scene("cave");
  s.state.node_reported(nodes[0], report);
  EXPECT_TRUE(s.delegate.ended_nodes.contains(nodes[0]));
}

TEST_F(CoordinatorFaultsTest, frames_of_two_sessions_alternate_and_refinements_come_last) {
  open(1);
  const SessionId other = s.add_session(50.0);
  drain_opened(s, other);
  s.request_view(other, view_of(1));
  s.settle(nodes);
  s.clock.advance(1s);
  s.state.tick();  // The other session is at rest now.
  const auto at_rest = blocks(s.delegate.commands[nodes[0]]);
  ASSERT_FALSE(at_rest.empty());
  for (const wire::RenderBlock& block : at_rest) EXPECT_TRUE(block.keep());
  s.request_view(session, view_of(++number));
  const auto both = blocks(s.delegate.commands[nodes[0]]);
  ASSERT_GT(both.size(), at_rest.size());
  EXPECT_LT(both.back().rank(), at_rest.front().rank());
}

TEST_F(CoordinatorFaultsTest, nodes_forget_the_pictures_of_a_session_that_left) {
  open(2);
  s.state.session_disconnected(session);
  for (const NodeId node : nodes) {
    ASSERT_FALSE(s.delegate.commands[node].empty());
    EXPECT_EQ(s.delegate.commands[node].back().forget_session().session(), static_cast<std::uint64_t>(session));
  }
}

}  // namespace
}  // namespace cyclorama::coordinator
