// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/deadlines.h"

#include <gtest/gtest.h>

#include "tests/doubles/fake_clock.h"

namespace cyclorama::coordinator {
namespace {

constexpr NodeId kQuick{1};
constexpr NodeId kSilent{2};

/// Two nodes with one block each of the only frame of a session, whose frames take a second. The quick one is done.
class DeadlinesTest : public ::testing::Test {
 protected:
  DeadlinesTest() {
    for (const NodeId id : {kQuick, kSilent}) {
      nodes.add(id, clock.now());
      nodes.at(id).threads = 4.0;
      nodes.at(id).scenes["cave"].state = Node::SceneState::kLoaded;
    }
    session.scene = "cave";
    session.account = AccountId{1};
    session.pace_seconds = 1.0;
    FrameInFlight& frame = session.frames.emplace_back();
    frame.begun = true;
    frame.foremost_since = frame.planned_at = clock.now();
    frame.assembly.plan(1, kQuick, {0, 0, 256, 256});
    frame.assembly.plan(2, kSilent, {256, 0, 256, 256});
    frame.assembly.end(1, {});
  }
  FrameInFlight& frame() { return session.frames.front(); }
  std::vector<NodeId> silent() { return deadlines.silent_nodes(session, frame()); }
  void advance_ms(int ms) { clock.advance(std::chrono::milliseconds(ms)); }

  FakeClock clock;
  NodeTable nodes;
  NodeSpeeds speeds;
  Deadlines deadlines{nodes, speeds, clock};
  Session session;
};

TEST_F(DeadlinesTest, a_node_is_silent_after_most_of_the_base_time_while_another_is_done) {
  EXPECT_EQ(deadlines.due(session).next, clock.now() + std::chrono::milliseconds(600));
  advance_ms(599);
  EXPECT_TRUE(silent().empty());
  advance_ms(1);
  EXPECT_EQ(silent(), std::vector<NodeId>{kSilent});
  nodes.at(kSilent).worked_at = clock.now();
  EXPECT_TRUE(silent().empty()) << "it has sent a tile";
}

TEST_F(DeadlinesTest, the_earliest_deadline_stays_after_it_has_passed) {
  const TimePoint first = clock.now() + std::chrono::milliseconds(600);
  EXPECT_EQ(deadlines.due(session).earliest, first);
  advance_ms(700);
  EXPECT_EQ(deadlines.due(session).earliest, first);
  EXPECT_EQ(deadlines.due(session).next, first + std::chrono::milliseconds(1400)) << "the frame is late then";
}

TEST_F(DeadlinesTest, no_node_is_silent_while_all_are_at_work) {
  frame().assembly.plan(3, kQuick, {0, 256, 256, 256});
  advance_ms(5000);
  EXPECT_TRUE(silent().empty());
}

TEST_F(DeadlinesTest, a_node_that_is_late_already_is_not_silent_again) {
  nodes.at(kSilent).late_for = {session.account};
  advance_ms(5000);
  EXPECT_TRUE(silent().empty());
}

TEST_F(DeadlinesTest, a_node_has_the_time_that_its_block_was_expected_to_take) {
  frame().assembly.plan(3, kSilent, {0, 256, 256, 256}, {8.0, 1.0, false});  // Two seconds with four threads.
  frame().assembly.give_up(2);
  session.costs_known = true;
  advance_ms(2999);
  EXPECT_TRUE(silent().empty());
  advance_ms(1);
  EXPECT_EQ(silent(), std::vector<NodeId>{kSilent});
}

TEST_F(DeadlinesTest, a_frame_is_late_after_twice_the_base_time_and_a_picture_at_rest_never) {
  advance_ms(1999);
  EXPECT_FALSE(deadlines.is_late(session, frame()));
  EXPECT_EQ(deadlines.due(session).next, clock.now() + std::chrono::milliseconds(1));
  advance_ms(1);
  EXPECT_TRUE(deadlines.is_late(session, frame()));
  EXPECT_EQ(deadlines.due(session).next, TimePoint::max()) << "all of them have passed";
  frame().refines = governor::SampleRange{0, 1};
  EXPECT_FALSE(deadlines.is_late(session, frame()));
}

TEST_F(DeadlinesTest, a_session_without_frames_has_none) {
  session.frames.clear();
  EXPECT_EQ(deadlines.due(session).next, TimePoint::max());
  EXPECT_EQ(deadlines.due(session).earliest, TimePoint::max());
}

}  // namespace
}  // namespace cyclorama::coordinator
