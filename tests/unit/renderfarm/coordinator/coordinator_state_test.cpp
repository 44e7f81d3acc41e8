// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/coordinator_state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "tests/support/farm_simulation.h"

namespace cyclorama::coordinator {
namespace {

using testing::Contains;
using testing::HasSubstr;

TEST(CoordinatorState, relays_the_older_frame_first_and_holds_the_newer_ones_tiles) {
  FarmSimulation s;
  const NodeId a = s.add_node();
  const NodeId b = s.add_node();
  const SessionId session = s.add_session();
  while (s.delegate.replies[session].size() > 0) {
    const auto opened = s.delegate.replies[session].front();
    s.delegate.replies[session].pop_front();
    s.state.written(session, opened);
  }
  s.request_view(session, view_of(1));
  s.request_view(session, view_of(2));
  while (s.work(a)) {
  }
  // All tiles of node a have arrived, of both frames; only those of frame 1 may be relayed.
  for (const auto& reply : s.delegate.replies[session]) {
    EXPECT_TRUE(!reply.has_tile() || reply.tile().view_number() == 1);
    EXPECT_FALSE(reply.has_end());
  }
  s.settle({a, b});
  EXPECT_EQ(s.complete, 2);
  EXPECT_EQ(s.last_end.nodes(), 2u);
  EXPECT_GT(s.last_end.balance_efficiency(), 0.7);  // The faster node took over some blocks of the other.
}

TEST(CoordinatorState, keeps_at_most_two_frames_for_a_museum_that_takes_nothing) {
  FarmSimulation s;
  const NodeId node = s.add_node();
  const SessionId session = s.add_session();
  drain_opened(s, session);
  for (std::uint64_t number = 1; number <= 50; ++number) {
    wire::SessionRequest request;
    *request.mutable_view() = view_of(number);
    s.state.session_requested(session, request, s.clock.now());
    while (s.work(node)) {
    }
  }
  int begun = 0;
  for (const auto& reply : s.delegate.replies[session]) begun += reply.has_begin() ? 1 : 0;
  EXPECT_EQ(begun, 2);
}

TEST(CoordinatorState, abandons_a_frame_over_the_limit_with_a_reason) {
  CoordinatorLimits limits;
  limits.session_bytes = 1000;
  FarmSimulation s(limits);
  s.tile_bytes = 300;
  const NodeId node = s.add_node();
  const SessionId session = s.add_session();
  drain_opened(s, session);
  s.request_view(session, view_of(1));
  while (s.work(node)) {
  }
  s.settle({node});
  EXPECT_EQ(s.given_up, 1);
  EXPECT_THAT(s.last_end.reason(), HasSubstr("more slowly"));
  s.request_view(session, view_of(2, 256, 256));
  s.settle({node});
  EXPECT_EQ(s.complete, 1);
}

wire::View deep_view(std::uint64_t number) {
  wire::View view = view_of(number, 256, 256);
  view.set_depth(true);
  return view;
}

TEST(CoordinatorState, forwards_the_bytes_of_depth_unchanged) {
  FarmSimulation s;
  const NodeId node = s.add_node();
  const SessionId session = s.add_session();
  drain_opened(s, session);
  s.request_view(session, deep_view(1));
  while (s.work(node)) {
  }
  int tiles = 0;
  for (const wire::SessionReply& reply : s.delegate.replies[session]) {
    if (!reply.has_tile()) continue;
    ++tiles;
    EXPECT_EQ(reply.tile().depth(), "ddddd");
  }
  EXPECT_GT(tiles, 0);
}

TEST(CoordinatorState, counts_depth_among_the_bytes_that_wait) {
  for (const std::size_t depth_bytes : {100u, 1900u}) {
    CoordinatorLimits limits;
    limits.session_bytes = 1000;
    FarmSimulation s(limits);
    s.tile_bytes = 300;
    s.depth_bytes = depth_bytes;
    const NodeId node = s.add_node();
    const SessionId session = s.add_session();
    drain_opened(s, session);
    for (std::uint64_t number = 1; number <= 3; ++number) {  // What was taken does not wait any more.
      s.request_view(session, deep_view(number));
      while (s.work(node)) {
      }
      s.settle({node});
    }
    EXPECT_EQ(s.given_up, depth_bytes > 1000 ? 3 : 0);
    EXPECT_EQ(s.complete, depth_bytes > 1000 ? 0 : 3);
  }
}

TEST(CoordinatorState, disconnects_a_node_that_sends_depth_unasked_or_too_much_of_it) {
  for (const bool unasked : {true, false}) {
    FarmSimulation s;
    s.sends_depth_unasked = unasked;
    s.depth_bytes = unasked ? 1 : 2 * 64 * 64 + 1025;
    const NodeId node = s.add_node();
    const SessionId session = s.add_session();
    drain_opened(s, session);
    s.request_view(session, unasked ? view_of(1, 256, 256) : deep_view(1));
    s.work(node);
    ASSERT_EQ(s.delegate.ended_nodes.count(node), 1u);
    EXPECT_THAT(s.delegate.ended_nodes.at(node).message(), HasSubstr("depth"));
  }
}

TEST(CoordinatorState, ends_a_session_that_takes_no_messages_for_long) {
  FarmSimulation s;
  const NodeId node = s.add_node();
  const SessionId session = s.add_session();
  drain_opened(s, session);
  s.request_view(session, view_of(1));
  while (s.work(node)) {
  }
  s.clock.advance(std::chrono::seconds(29));
  s.state.tick();
  EXPECT_TRUE(s.delegate.ended_sessions.empty());
  s.clock.advance(std::chrono::seconds(2));
  s.state.tick();
  ASSERT_EQ(s.delegate.ended_sessions.size(), 1u);
  EXPECT_EQ(s.delegate.ended_sessions.at(session).code(), ErrorCode::kTimedOut);
  EXPECT_EQ(s.state.sessions(), 0u);
}

TEST(CoordinatorState, disconnects_peers_that_send_nothing) {
  FarmSimulation s;
  s.state.node_connected(NodeId{1000});
  s.state.session_connected(SessionId{1000});
  s.clock.advance(std::chrono::seconds(11));
  s.state.tick();
  EXPECT_EQ(s.delegate.ended_nodes.count(NodeId{1000}), 1u);
  EXPECT_EQ(s.delegate.ended_sessions.count(SessionId{1000}), 1u);
}

TEST(CoordinatorState, reassigns_a_failed_block_a_limited_number_of_times) {
  FarmSimulation s;
  const NodeId good = s.add_node();
  const NodeId bad = s.add_node();
  const SessionId session = s.add_session();
  drain_opened(s, session);
  s.request_view(session, view_of(1));
  s.work(bad, "the disk is on fire");
  s.settle({good, bad});
  EXPECT_EQ(s.complete, 1);
  EXPECT_THAT(s.delegate.notices, Contains(HasSubstr("the disk is on fire")));
  s.request_view(session, view_of(2));
  for (int i = 0; i < 1000 && (s.work(bad, "fire") || s.work(good, "fire")); ++i) {
  }
  s.settle({good, bad});
  EXPECT_EQ(s.given_up, 1);
}

TEST(CoordinatorState, steals_from_a_straggler_once_the_others_are_idle) {
  FarmSimulation s;
  const NodeId quick = s.add_node();
  const NodeId slow = s.add_node();
  const SessionId session = s.add_session();
  drain_opened(s, session);
  s.request_view(session, view_of(1));
  while (s.work(quick)) {
  }
  s.clock.advance(std::chrono::milliseconds(290));  // A first frame may take half a second.
  s.state.tick();
  EXPECT_FALSE(s.work(quick));
  s.clock.advance(std::chrono::milliseconds(20));
  s.state.tick();
  EXPECT_TRUE(s.work(quick));
  s.request_view(session, view_of(2));  // While the node is silent, it gets no new blocks.
  s.settle({quick});
  EXPECT_EQ(s.complete, 2);
  s.work(slow);  // The node resumes: tiles that it delivers first count, the rest are dropped.
  s.settle({quick, slow});
  s.request_view(session, view_of(3));
  s.settle({quick, slow});
  EXPECT_EQ(s.complete, 3);
  EXPECT_EQ(s.last_end.nodes(), 2u);
}

TEST(CoordinatorState, does_not_mix_nodes_with_different_scenes) {
  FarmSimulation s;
  s.add_node();
  const NodeId other{500};
  s.state.node_connected(other);
  wire::NodeReport report;
  report.mutable_hello()->set_version(CYCLORAMA_VERSION);
  report.mutable_hello()->set_threads(1);
  s.state.node_reported(other, report);
  report.mutable_scene_loaded()->set_scene("grotto");
  *report.mutable_scene_loaded()->mutable_description() = fake_scene("grotto");
  report.mutable_scene_loaded()->mutable_description()->set_triangles_stored(13);
  s.state.node_reported(other, report);
  EXPECT_EQ(s.state.nodes_with("grotto"), 1u);
  EXPECT_THAT(s.delegate.notices, Contains(HasSubstr("another scene")));
}

TEST(CoordinatorState, accepts_a_limited_number_of_peers) {
  CoordinatorLimits limits;
  limits.nodes = 1;
  limits.sessions = 1;
  FarmSimulation s(limits);
  s.add_node();
  s.add_session();
  s.state.node_connected(NodeId{100});
  s.state.session_connected(SessionId{100});
  EXPECT_EQ(s.delegate.ended_nodes.at(NodeId{100}).code(), ErrorCode::kBusy);
  EXPECT_EQ(s.delegate.ended_sessions.at(SessionId{100}).code(), ErrorCode::kBusy);
}

TEST(CoordinatorState, stops_rendering_for_a_museum_that_left) {
  FarmSimulation s;
  const NodeId node = s.add_node();
  const SessionId session = s.add_session();
  drain_opened(s, session);
  s.request_view(session, view_of(1));
  s.state.session_disconnected(session);
  EXPECT_THAT(s.delegate.commands[node], Contains(testing::Property(&wire::NodeCommand::has_cancel, true)));
  s.windows.clear();
  s.settle({node});  // Its late tiles are ignored.
  EXPECT_TRUE(s.delegate.ended_nodes.empty());
}

TEST(CoordinatorState, keeps_its_guarantees_for_any_order_of_events) {
  for (unsigned seed = 0; seed < 150; ++seed) {
    std::mt19937 random(seed);
    const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
    const auto chance = [&](std::uint32_t of) { return below(of) == 0; };
    FarmSimulation s;
    std::vector<NodeId> nodes{s.add_node(1), s.add_node(4)};
    std::vector<SessionId> sessions;
    for (int i = 0; i < 2; ++i) {
      sessions.push_back(s.add_session());
      drain_opened(s, sessions.back());
    }
    std::map<SessionId, std::uint64_t> newest;
    for (int step = 0; step < 600; ++step) {
      s.clock.advance(std::chrono::milliseconds(below(40)));
      const SessionId session = sessions[below(2)];
      if (chance(6)) s.request_view(session, view_of(++newest[session], 16 + below(1500), 16 + below(700)));
      if (chance(3)) s.take(session);
      if (!nodes.empty()) s.work(nodes[below(static_cast<std::uint32_t>(nodes.size()))], chance(60) ? "it failed" : "");
      if (chance(80) && nodes.size() > 1) {
        const std::size_t which = below(static_cast<std::uint32_t>(nodes.size()));
        s.kill(nodes[which]);
        nodes.erase(nodes.begin() + static_cast<std::ptrdiff_t>(which));
      }
      if (chance(80) && nodes.size() < 6) nodes.push_back(s.add_node(1 + below(8)));
      if (chance(5)) s.state.tick();
    }
    s.settle(nodes);
    EXPECT_TRUE(s.delegate.ended_nodes.empty());
    EXPECT_TRUE(s.delegate.ended_sessions.empty());
    for (const SessionId session : sessions) {
      EXPECT_EQ(s.answered[session], newest[session]) << "seed " << seed;
      EXPECT_EQ(s.windows.at(session).in_flight(), 0u);
    }
    EXPECT_GT(s.complete, 5);
    ASSERT_FALSE(testing::Test::HasFailure()) << "seed " << seed;
  }
}

}  // namespace
}  // namespace cyclorama::coordinator
