// SPDX-License-Identifier: Apache-2.0
// Governed sessions of CoordinatorState.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "common/wire/convert.h"
#include "tests/support/farm_simulation.h"

namespace cyclorama::coordinator {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

/// A farm with one governed session, where a frame's time depends on its samples and pixels.
class GovernedSession : public testing::Test {
 protected:
  /// Returns the samples of a requested pixel.
  static double samples_of(const wire::View& planned) {
    return planned.samples() * (planned.panorama().width_px() / 1024.0) * (planned.panorama().height_px() / 512.0);
  }
  void open(double budget_ms, std::uint32_t reference_samples, int count = 2) {
    for (int i = 0; i < count; ++i) nodes.push_back(s.add_node());
    session = s.add_session(budget_ms, reference_samples);
    drain_opened(s, session);
  }
  /// Renders one frame of a moving view, from the request until the museum has taken it.
  void move(double ms_per_sample = 1.0, double fixed_ms = 0.0) {
    s.request_view(session, view_of(++number));
    const wire::View& planned = s.delegate.commands[nodes.front()].back().render().view();
    s.clock.advance(std::chrono::duration_cast<Duration>(
        std::chrono::duration<double, std::milli>(fixed_ms + ms_per_sample * samples_of(planned))));
    s.settle(nodes);
  }
  /// Stops when the first refined picture is ordered and no node has begun it.
  void begin_rest() {
    s.clock.advance(200ms);
    s.state.tick();
  }
  /// Lets time pass without a request.
  void stand_still(Duration time) {
    for (Duration passed{}; passed < time; passed += 100ms) {
      s.clock.advance(100ms);
      s.state.tick();
      s.settle(nodes);
    }
  }
  [[nodiscard]] std::vector<std::uint32_t> samples_begun() const {
    std::vector<std::uint32_t> samples;
    for (const wire::View& view : s.begun) samples.push_back(view.first_sample() + view.samples());
    return samples;
  }

  FarmSimulation s;
  std::vector<NodeId> nodes;
  SessionId session{};
  std::uint64_t number = 0;
};

TEST_F(GovernedSession, moves_to_the_best_picture_that_fits_the_budget) {
  open(20.0, 64);
  for (int frame = 0; frame < 60; ++frame) move(4.0);
  EXPECT_EQ(s.begun.front().panorama().width_px(), 352u) << "the cheapest first";
  EXPECT_GT(4.0 * samples_of(s.begun.back()), 15.0);
  EXPECT_LT(4.0 * samples_of(s.begun.back()), 20.0);
  EXPECT_GE(s.begun.back().panorama().width_px(), 720u);
  for (int frame = 0; frame < 60; ++frame) move(16.0);
  EXPECT_GT(16.0 * samples_of(s.begun.back()), 15.0);
  EXPECT_LT(16.0 * samples_of(s.begun.back()), 20.0);
  EXPECT_EQ(s.begun.back().samples(), 2u);
  EXPECT_EQ(s.complete, 120);
  EXPECT_EQ(s.last_end.reference_samples(), 64u);
  EXPECT_THAT(s.state.summary(), HasSubstr("moving, 2 samples at 7"));
}

TEST_F(GovernedSession, uses_what_a_fixed_part_of_the_time_leaves) {
  open(50.0, 64);
  for (int frame = 0; frame < 60; ++frame) move(10.0, 10.0);
  EXPECT_GT(10.0 * samples_of(s.begun.back()), 30.0);
  EXPECT_LT(10.0 * samples_of(s.begun.back()), 40.0);
}

TEST_F(GovernedSession, has_the_same_bounces_in_every_picture) {
  open(20.0, 64);
  for (int frame = 0; frame < 30; ++frame) move();
  stand_still(5s);
  for (const wire::View& view : s.begun) EXPECT_EQ(view.bounces(), 4u) << view.samples();
}

TEST_F(GovernedSession, has_the_bounces_that_the_view_states) {
  open(20.0, 64);
  wire::View view = view_of(++number);
  view.set_bounces(2);
  s.request_view(session, view);
  s.settle(nodes);
  stand_still(1s);
  EXPECT_GT(s.begun.size(), 1u);
  for (const wire::View& begun : s.begun) EXPECT_EQ(begun.bounces(), 2u);
}

TEST_F(GovernedSession, has_the_bounces_of_its_scene) {
  s.scene_bounces = 7;
  open(20.0, 64);
  move();
  EXPECT_EQ(s.begun.back().bounces(), 7u);
}

TEST_F(GovernedSession, refuses_a_node_whose_scene_has_too_many_bounces) {
  s.scene_bounces = 65;
  const NodeId node = s.add_node();
  EXPECT_TRUE(s.delegate.ended_nodes.contains(node));
}

TEST_F(GovernedSession, has_depth_in_moving_pictures_on_request_and_in_none_at_rest) {
  open(20.0, 64);
  for (const bool deep : {true, false}) {
    s.begun.clear();
    wire::View view = view_of(++number);
    view.set_depth(deep);
    s.request_view(session, view);
    s.settle(nodes);
    stand_still(1s);
    ASSERT_GT(s.begun.size(), 1u);
    for (const wire::View& begun : s.begun) {
      EXPECT_EQ(begun.depth(), deep && &begun == &s.begun.front()) << begun.first_sample();
    }
  }
  EXPECT_TRUE(s.delegate.ended_nodes.empty());
}

TEST_F(GovernedSession, leaves_a_session_without_a_budget_at_its_views_quality) {
  open(0.0, 0);
  move();
  stand_still(10s);
  ASSERT_EQ(s.begun.size(), 1u);
  EXPECT_EQ(s.begun.front().samples(), 1u);
  EXPECT_EQ(s.last_end.samples(), 1u);
  EXPECT_EQ(s.last_end.reference_samples(), 0u);
}

TEST_F(GovernedSession, refines_to_the_reference_and_then_rests) {
  open(20.0, 64);
  move();
  s.begun.clear();
  stand_still(200ms);
  ASSERT_FALSE(s.begun.empty());
  stand_still(5s);
  EXPECT_EQ(samples_begun(), (std::vector<std::uint32_t>{4, 8, 16, 32, 64}));
  for (const wire::View& view : s.begun) {
    EXPECT_EQ(view.number(), 1u);
    EXPECT_EQ(view.panorama().width_px(), 1024u) << "of the size asked for, whatever the moving one had";
    EXPECT_EQ(view.shutter_ns(), 0);
  }
  EXPECT_EQ(s.last_end.samples(), 64u);
  EXPECT_TRUE(s.last_end.stages().empty());
  EXPECT_TRUE(s.delegate.frames.back().refined);
  EXPECT_THAT(s.state.summary(), HasSubstr("at rest with 64 samples"));
  const std::size_t orders = s.orders.size();
  stand_still(60s);
  EXPECT_EQ(s.begun.size(), 5u);
  EXPECT_EQ(s.orders.size(), orders) << "nodes rest, too";
}

TEST_F(GovernedSession, renders_each_part_where_its_samples_are) {
  open(20.0, 64, 3);
  for (int frame = 0; frame < 3; ++frame) move();
  s.orders.clear();
  stand_still(5s);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::set<NodeId>> makers;
  std::set<NodeId> all;
  for (const auto& [block, order] : s.orders) {
    EXPECT_TRUE(order.second.keep());
    EXPECT_EQ(order.second.session(), static_cast<std::uint64_t>(session));
    makers[{order.second.x_px(), order.second.y_px()}].insert(order.first);
    all.insert(order.first);
  }
  ASSERT_EQ(all.size(), 3u);
  EXPECT_LT(makers.size(), s.orders.size());  // There were several pictures with the same parts.
  for (const auto& [corner, nodes_of_it] : makers) EXPECT_EQ(nodes_of_it.size(), 1u);
}

TEST_F(GovernedSession, aborts_a_refinement_completely_when_a_view_arrives) {
  open(20.0, 1024);
  move();
  begin_rest();
  const std::size_t seen = s.begun.size();
  const int given_up = s.given_up;
  s.work(nodes[0]);  // Renders a tile of the next picture, which must not be sent.
  for (const auto& reply : s.delegate.replies[session]) ADD_FAILURE() << reply.ShortDebugString();
  s.request_view(session, view_of(++number));
  bool cancelled = false;
  for (const NodeId node : nodes) {
    for (const auto& command : s.delegate.commands[node]) cancelled = cancelled || command.has_cancel();
  }
  EXPECT_TRUE(cancelled);
  s.settle(nodes);
  ASSERT_EQ(s.begun.size(), seen + 1);
  EXPECT_EQ(s.begun.back().number(), 2u);
  EXPECT_EQ(s.begun.back().first_sample(), 0u);
  EXPECT_EQ(s.given_up, given_up);
  stand_still(20s);
  EXPECT_EQ(s.last_end.samples(), 1024u);
  EXPECT_EQ(s.last_end.view_number(), 2u);
  ASSERT_GT(s.begun.size(), seen + 2);
  EXPECT_EQ(s.begun[seen + 1].first_sample(), 0u) << "nothing of the old view is added";
  EXPECT_EQ(s.begun[seen + 2].first_sample(), s.begun[seen + 1].samples());
}

TEST_F(GovernedSession, continues_a_refinement_when_a_node_disconnects) {
  open(20.0, 256);
  move();
  begin_rest();
  s.work(nodes.back());
  s.kill(nodes.back());
  nodes.pop_back();
  stand_still(20s);
  EXPECT_EQ(s.last_end.samples(), 256u);
  EXPECT_EQ(s.last_end.nodes(), 1u);
  EXPECT_EQ(s.given_up, 0);
}

TEST_F(GovernedSession, reaches_the_reference_after_its_only_node_was_lost_and_came_back) {
  open(20.0, 256, 1);
  move();
  begin_rest();
  s.work(nodes[0]);
  s.kill(nodes[0]);
  nodes = {};
  stand_still(7s);
  EXPECT_EQ(s.last_end.samples(), s.begun.back().samples()) << "only the moving one";
  nodes = {s.add_node()};
  stand_still(5s);
  EXPECT_EQ(s.last_end.samples(), 256u);
  EXPECT_EQ(s.last_end.view_number(), 1u);
  EXPECT_THAT(s.state.summary(), HasSubstr("at rest with 256 samples"));
  EXPECT_THAT(s.state.summary(), Not(HasSubstr("failed")));
}

TEST_F(GovernedSession, shows_what_it_has_when_refining_fails_and_retries_ever_more_rarely) {
  open(20.0, 256, 1);
  move();
  begin_rest();
  const std::size_t seen = s.begun.size();
  const auto fails = [&] {
    int done = 0;
    while (s.work(nodes[0], "the disk is on fire")) ++done;
    return done > 0;
  };
  for (const Duration wait : {5s, 10s, 20s, 40s, 60s, 60s}) {
    EXPECT_TRUE(fails());
    EXPECT_THAT(s.state.summary(), HasSubstr("more failed"));
    s.clock.advance(wait - 1ms);
    s.state.tick();
    EXPECT_FALSE(fails()) << "sooner than after " << to_seconds(wait) << " s";
    s.clock.advance(1ms);
    s.state.tick();
  }
  EXPECT_TRUE(fails());
  EXPECT_EQ(s.begun.size(), seen);
  move();
  stand_still(4s);
  EXPECT_EQ(s.last_end.samples(), 256u) << "the next view does not wait";
}

TEST_F(GovernedSession, does_not_take_a_late_tile_of_the_moving_frame_for_a_refined_one) {
  open(20.0, 64);
  s.request_view(session, view_of(++number));
  while (s.work(nodes[0])) {
  }
  s.clock.advance(600ms);
  s.state.tick();  // The other node is late; the first takes over, and the frame ends.
  s.settle({nodes[0]});
  ASSERT_EQ(s.complete, 1);
  begin_rest();
  s.settle({nodes[0]});
  s.settle(nodes);
  EXPECT_TRUE(s.delegate.ended_nodes.empty());
  stand_still(20s);
  EXPECT_EQ(s.last_end.samples(), 64u);
}

TEST_F(GovernedSession, waits_for_a_museum_that_takes_slowly) {
  open(20.0, 64);
  s.request_view(session, view_of(++number));
  for (const NodeId node : nodes) {
    while (s.work(node)) {
    }
  }
  s.clock.advance(5s);
  s.state.tick();
  EXPECT_TRUE(std::ranges::none_of(nodes, [&](NodeId node) { return s.work(node); })) << "it has frame 1 to take yet";
  s.settle(nodes);
  stand_still(5s);
  EXPECT_EQ(s.last_end.samples(), 64u);
}

TEST_F(GovernedSession, refuses_budgets_and_views_out_of_range) {
  s.add_node();
  const auto refused = [&](double budget_ms, std::uint32_t samples) {
    const SessionId id = s.add_session(budget_ms, samples);
    const bool ended = s.delegate.ended_sessions.count(id) > 0;
    if (ended) s.windows.erase(id);
    return ended;
  };
  EXPECT_TRUE(refused(-1.0, 1));
  EXPECT_TRUE(refused(std::nan(""), 1));
  EXPECT_TRUE(refused(1e9, 1));
  EXPECT_TRUE(refused(50.0, 4097));
  EXPECT_FALSE(refused(50.0, 4096));
  EXPECT_FALSE(refused(1e-3, 1));
  const SessionId id = s.add_session(50.0);
  wire::View view = view_of(1);
  view.set_first_sample(1);
  s.request_view(id, view);
  EXPECT_EQ(s.delegate.ended_sessions.count(id), 1u);
}

TEST_F(GovernedSession, separates_two_eyes_pictures_of_any_size) {
  open(20.0, 64);
  std::set<std::uint32_t> heights;
  for (int frame = 0; frame < 80; ++frame) {
    wire::View view = view_of(++number);
    view.mutable_panorama()->mutable_eyes()->set_distance_m(0.063);
    view.mutable_panorama()->set_height_px(608);  // 19 cells for each eye.
    s.request_view(session, view);
    s.clock.advance(frame < 40 ? 1ms : 60ms);
    s.settle(nodes);
    heights.insert(s.begun.back().panorama().height_px());
    ASSERT_TRUE(s.begun.back().panorama().has_eyes());
    ASSERT_TRUE(validate(s.begun.back())) << validate(s.begun.back()).error().message();
  }
  EXPECT_GT(heights.size(), 1u);
  for (const std::uint32_t height : heights) EXPECT_EQ(height % 32, 0u);
}

}  // namespace
}  // namespace cyclorama::coordinator
