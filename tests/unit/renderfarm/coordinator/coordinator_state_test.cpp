// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/coordinator_state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "tests/doubles/farm_simulation.h"

namespace cyclorama {
namespace {

using testing::Contains;
using testing::HasSubstr;

TEST(HeadState, relays_the_older_frame_first_and_holds_the_newer_ones_tiles) {
  FarmSimulation s;
  const NodeId a = s.add_node();
  const NodeId b = s.add_node();
  const SessionId visit = s.add_visit();
  while (s.peers.replies[visit].size() > 0) {
    const auto opened = s.peers.replies[visit].front();
    s.peers.replies[visit].pop_front();
    s.state.written(visit, opened);
  }
  s.ask(visit, view_of(1));
  s.ask(visit, view_of(2));
  while (s.work(a)) {
  }
  // All of a's tiles of both frames are in; only frame 1's may be on their way.
  for (const auto& reply : s.peers.replies[visit]) {
    EXPECT_TRUE(!reply.has_tile() || reply.tile().view_number() == 1);
    EXPECT_FALSE(reply.has_end());
  }
  s.settle({a, b});
  EXPECT_EQ(s.complete, 2);
  EXPECT_EQ(s.last_end.nodes(), 2u);
  EXPECT_GT(s.last_end.balance_efficiency(), 0.7);  // The quicker one took a little of the other's.
}

TEST(HeadState, keeps_at_most_two_frames_for_a_museum_that_takes_nothing) {
  FarmSimulation s;
  const NodeId node = s.add_node();
  const SessionId visit = s.add_visit();
  drain_opened(s, visit);
  for (std::uint64_t number = 1; number <= 50; ++number) {
    wire::VisitRequest request;
    *request.mutable_view() = view_of(number);
    s.state.visit_asked(visit, request, s.clock.now());
    while (s.work(node)) {
    }
  }
  int begun = 0;
  for (const auto& reply : s.peers.replies[visit]) begun += reply.has_begin() ? 1 : 0;
  EXPECT_EQ(begun, 2);
}

TEST(HeadState, gives_a_frame_up_that_is_too_large_to_keep_and_says_why) {
  HeadLimits limits;
  limits.session_bytes = 1000;
  FarmSimulation s(limits);
  s.tile_bytes = 300;
  const NodeId node = s.add_node();
  const SessionId visit = s.add_visit();
  drain_opened(s, visit);
  s.ask(visit, view_of(1));
  while (s.work(node)) {
  }
  s.settle({node});
  EXPECT_EQ(s.given_up, 1);
  EXPECT_THAT(s.last_end.reason(), HasSubstr("more slowly"));
  s.ask(visit, view_of(2, 256, 256));
  s.settle({node});
  EXPECT_EQ(s.complete, 1);
}

TEST(HeadState, ends_a_visit_that_takes_nothing_for_long) {
  FarmSimulation s;
  const NodeId node = s.add_node();
  const SessionId visit = s.add_visit();
  drain_opened(s, visit);
  s.ask(visit, view_of(1));
  while (s.work(node)) {
  }
  s.clock.advance(std::chrono::seconds(29));
  s.state.tick();
  EXPECT_TRUE(s.peers.ended_visits.empty());
  s.clock.advance(std::chrono::seconds(2));
  s.state.tick();
  ASSERT_EQ(s.peers.ended_visits.size(), 1u);
  EXPECT_EQ(s.peers.ended_visits.at(visit).code(), ErrorCode::kTimedOut);
  EXPECT_EQ(s.state.sessions(), 0u);
}

TEST(HeadState, sends_strangers_away_who_say_nothing) {
  FarmSimulation s;
  s.state.node_came(NodeId{1000});
  s.state.visit_came(SessionId{1000});
  s.clock.advance(std::chrono::seconds(11));
  s.state.tick();
  EXPECT_EQ(s.peers.ended_nodes.count(NodeId{1000}), 1u);
  EXPECT_EQ(s.peers.ended_visits.count(SessionId{1000}), 1u);
}

TEST(HeadState, gives_a_block_that_failed_to_another_node_and_not_for_ever) {
  FarmSimulation s;
  const NodeId good = s.add_node();
  const NodeId bad = s.add_node();
  const SessionId visit = s.add_visit();
  drain_opened(s, visit);
  s.ask(visit, view_of(1));
  s.work(bad, "the disk is on fire");
  s.settle({good, bad});
  EXPECT_EQ(s.complete, 1);
  EXPECT_THAT(s.peers.notices, Contains(HasSubstr("the disk is on fire")));
  s.ask(visit, view_of(2));
  for (int i = 0; i < 1000 && (s.work(bad, "fire") || s.work(good, "fire")); ++i) {
  }
  s.settle({good, bad});
  EXPECT_EQ(s.given_up, 1);
}

TEST(HeadState, helps_a_straggler_once_the_others_are_done) {
  FarmSimulation s;
  const NodeId quick = s.add_node();
  const NodeId slow = s.add_node();
  const SessionId visit = s.add_visit();
  drain_opened(s, visit);
  s.ask(visit, view_of(1));
  while (s.work(quick)) {
  }
  s.clock.advance(std::chrono::milliseconds(290));  // Of the half second that a first frame may take.
  s.state.tick();
  EXPECT_FALSE(s.work(quick));
  s.clock.advance(std::chrono::milliseconds(20));
  s.state.tick();
  EXPECT_TRUE(s.work(quick));
  s.ask(visit, view_of(2));  // As long as it is silent, it gets nothing new to do.
  s.settle({quick});
  EXPECT_EQ(s.complete, 2);
  s.work(slow);  // It wakes up: what it brings first counts, the rest is dropped.
  s.settle({quick, slow});
  s.ask(visit, view_of(3));
  s.settle({quick, slow});
  EXPECT_EQ(s.complete, 3);
  EXPECT_EQ(s.last_end.nodes(), 2u);
}

TEST(HeadState, does_not_mix_nodes_with_different_scenes) {
  FarmSimulation s;
  s.add_node();
  const NodeId other{500};
  s.state.node_came(other);
  wire::NodeReport report;
  report.mutable_hello()->set_version(CYCLORAMA_VERSION);
  report.mutable_hello()->set_threads(1);
  s.state.node_reported(other, report);
  report.mutable_scene_loaded()->set_scene("grotto");
  *report.mutable_scene_loaded()->mutable_description() = fake_scene("grotto");
  report.mutable_scene_loaded()->mutable_description()->set_triangles_stored(13);
  s.state.node_reported(other, report);
  EXPECT_EQ(s.state.nodes_with("grotto"), 1u);
  EXPECT_THAT(s.peers.notices, Contains(HasSubstr("another scene")));
}

TEST(HeadState, takes_no_more_peers_than_it_may) {
  HeadLimits limits;
  limits.nodes = 1;
  limits.sessions = 1;
  FarmSimulation s(limits);
  s.add_node();
  s.add_visit();
  s.state.node_came(NodeId{100});
  s.state.visit_came(SessionId{100});
  EXPECT_EQ(s.peers.ended_nodes.at(NodeId{100}).code(), ErrorCode::kBusy);
  EXPECT_EQ(s.peers.ended_visits.at(SessionId{100}).code(), ErrorCode::kBusy);
}

TEST(HeadState, stops_rendering_for_a_museum_that_left) {
  FarmSimulation s;
  const NodeId node = s.add_node();
  const SessionId visit = s.add_visit();
  drain_opened(s, visit);
  s.ask(visit, view_of(1));
  s.state.visit_gone(visit);
  EXPECT_THAT(s.peers.commands[node], Contains(testing::Property(&wire::NodeCommand::has_cancel, true)));
  s.windows.clear();
  s.settle({node});  // What it still sends harms nobody.
  EXPECT_TRUE(s.peers.ended_nodes.empty());
}

TEST(HeadState, keeps_its_promises_whatever_happens_in_whatever_order) {
  for (unsigned seed = 0; seed < 150; ++seed) {
    std::mt19937 random(seed);
    const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
    const auto chance = [&](std::uint32_t of) { return below(of) == 0; };
    FarmSimulation s;
    std::vector<NodeId> nodes{s.add_node(1), s.add_node(4)};
    std::vector<SessionId> visits;
    for (int i = 0; i < 2; ++i) {
      visits.push_back(s.add_visit());
      drain_opened(s, visits.back());
    }
    std::map<SessionId, std::uint64_t> newest;
    for (int step = 0; step < 600; ++step) {
      s.clock.advance(std::chrono::milliseconds(below(40)));
      const SessionId visit = visits[below(2)];
      if (chance(6)) s.ask(visit, view_of(++newest[visit], 16 + below(1500), 16 + below(700)));
      if (chance(3)) s.take(visit);
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
    EXPECT_TRUE(s.peers.ended_nodes.empty());
    EXPECT_TRUE(s.peers.ended_visits.empty());
    for (const SessionId visit : visits) {
      EXPECT_EQ(s.answered[visit], newest[visit]) << "seed " << seed;
      EXPECT_EQ(s.windows.at(visit).in_flight(), 0u);
    }
    EXPECT_GT(s.complete, 5);
    ASSERT_FALSE(testing::Test::HasFailure()) << "seed " << seed;
  }
}

}  // namespace
}  // namespace cyclorama
