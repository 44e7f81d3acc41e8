// SPDX-License-Identifier: Apache-2.0
// Light that nodes compute while a visit goes on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "renderfarm/governor/pareto_front_file.h"
#include "renderfarm/governor/stored_light_front.h"
#include "tests/support/farm_simulation.h"

namespace cyclorama::coordinator {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

class CoordinatorLight : public testing::Test {
 protected:
  CoordinatorLight() {
    for (int i = 0; i < 2; ++i) nodes.push_back(s.add_node());
    session = s.add_session(20.0, 64);
    drain_opened(s, session);
  }
  void describe_again(NodeId node, const std::string& front, const std::string& note = "") {
    wire::NodeReport report;
    wire::SceneLoaded& loaded = *report.mutable_scene_loaded();
    loaded.set_scene("grotto");
    *loaded.mutable_description() = fake_scene("grotto");
    loaded.set_front(front);
    loaded.set_note(note);
    s.state.node_reported(node, report);
  }
  /// Renders a moving view and returns the nodes that had blocks of it; all of them must have had the same quality.
  std::set<NodeId> move(bool with_light) {
    s.request_view(session, view_of(++number));
    std::set<NodeId> busy;
    for (const auto& [node, commands] : s.delegate.commands) {
      for (const wire::NodeCommand& command : commands) {
        if (!command.has_render()) continue;
        EXPECT_EQ(command.render().view().stored_light(), with_light);
        busy.insert(node);
      }
    }
    s.clock.advance(std::chrono::milliseconds(10));
    s.settle(nodes);
    return busy;
  }
  void move_often(bool with_light) {
    for (int i = 0; i < 30; ++i) move(with_light);
  }

  FarmSimulation s;
  std::vector<NodeId> nodes;
  SessionId session{};
  std::uint64_t number = 0;
  const std::string lit = governor::pareto_front_text(governor::stored_light_front(4), "");
};

TEST_F(CoordinatorLight, is_used_by_an_open_session_from_the_next_frame_on_and_only_at_nodes_that_have_it) {
  move_often(false);
  describe_again(nodes[0], lit);
  EXPECT_THAT(s.delegate.notices, Contains(HasSubstr("scene 'grotto' has its light computed")));
  EXPECT_THAT(move(true), ElementsAre(nodes[0]));
  move_often(true);
  describe_again(nodes[1], lit);
  std::set<NodeId> busy;
  for (int i = 0; i < 30; ++i) busy.merge(move(true));
  EXPECT_THAT(busy, ElementsAre(nodes[0], nodes[1]));
  EXPECT_EQ(s.given_up, 0);
}

TEST_F(CoordinatorLight, does_not_change_a_frame_in_flight) {
  s.request_view(session, view_of(++number));
  describe_again(nodes[0], lit);
  for (const NodeId node : nodes) {
    for (const wire::NodeCommand& command : s.delegate.commands[node]) {
      EXPECT_FALSE(command.has_render() && command.render().view().stored_light());
    }
  }
  s.settle(nodes);
  EXPECT_EQ(s.complete, 1);
}

TEST_F(CoordinatorLight, is_given_up_with_the_last_node_that_has_it) {
  describe_again(nodes[0], lit);
  move_often(true);
  const NodeId gone = nodes[0];
  nodes.erase(nodes.begin());
  s.kill(gone);
  move_often(false);
  EXPECT_EQ(s.given_up, 0);
  EXPECT_THAT(s.delegate.notices, Contains(HasSubstr("no node has the computed light of scene 'grotto'")));
}

TEST_F(CoordinatorLight, that_failed_costs_one_notice_and_no_frame) {
  move_often(false);
  describe_again(nodes[0], "", "its light could not be computed ahead: the disk is full");
  move_often(false);
  EXPECT_EQ(s.given_up, 0);
  EXPECT_EQ(std::ranges::count_if(s.delegate.notices,
                                  [](const std::string& notice) { return notice.find("disk is full") != notice.npos; }),
            1);
}

TEST_F(CoordinatorLight, lets_a_picture_at_rest_go_on) {
  move_often(false);
  const auto rest = [&] {
    for (int i = 0; i < 5; ++i) {
      s.clock.advance(std::chrono::milliseconds(100));
      s.state.tick();
      s.settle(nodes);
    }
    return s.begun.back().first_sample() + s.begun.back().samples();
  };
  const std::uint32_t before = rest();
  EXPECT_GT(before, 1u);
  describe_again(nodes[0], lit);
  EXPECT_GE(rest(), before) << "it does not begin anew";
  move(true);
}

TEST_F(CoordinatorLight, shows_each_nodes_progress) {
  wire::NodeReport report;
  wire::LightProgress& light = *report.mutable_status()->add_light();
  light.set_scene("grotto");
  light.set_done_share(0.42);
  light.set_seconds_left(150.0);
  s.state.node_reported(nodes[1], report);
  const watch::FarmOverview farm = s.state.overview();
  EXPECT_THAT(farm.nodes[0].light, ElementsAre());
  EXPECT_THAT(farm.nodes[1].light, ElementsAre("grotto: 42 %, 3 min left"));
}

}  // namespace
}  // namespace cyclorama::coordinator
