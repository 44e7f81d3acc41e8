// SPDX-License-Identifier: Apache-2.0
// Light that nodes compute, send and fetch while a visit goes on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "renderfarm/scene_distribution/sha256.h"
#include "tests/support/farm_simulation.h"

namespace cyclorama::coordinator {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class CoordinatorLight : public testing::Test {
 protected:
  CoordinatorLight() {
    s.can_compute_light = true;
    for (int i = 0; i < 2; ++i) nodes.push_back(s.add_node());
    session = s.add_session(10.0, 64);  // No room beyond the pictures that read light.
    drain_opened(s, session);
  }
  static wire::LightVersion version(const std::string& name = "light") {
    wire::LightVersion light;
    light.set_version(scene_distribution::sha256_of(name));
    light.set_bytes(7);
    return light;
  }
  void report_light(NodeId node, const wire::LightVersion& light = version()) {
    wire::NodeReport report;
    report.mutable_scene_light()->set_scene("grotto");
    *report.mutable_scene_light()->mutable_light() = light;
    s.state.node_reported(node, report);
  }
  static wire::LightVersion piece_file(std::uint32_t stage, std::uint32_t piece) {
    return version(std::to_string(stage) + "-" + std::to_string(piece));
  }
  /// `key` is the digit of the stage's key.
  void report_pieces(NodeId node, std::uint32_t stage, std::uint32_t count, const std::vector<std::uint32_t>& pieces,
                     char key = 'a') {
    wire::NodeReport report;
    wire::LightPieces& message = *report.mutable_light_pieces();
    message.set_scene("grotto");
    message.mutable_stage()->set_number(stage);
    message.mutable_stage()->set_key(std::string(32, key));
    message.mutable_stage()->set_pieces(count);
    for (const std::uint32_t piece : pieces) {
      wire::LightPiece& taken = *message.add_pieces();
      taken.set_piece(piece);
      *taken.mutable_file() = piece_file(stage, piece);
    }
    s.state.node_reported(node, report);
  }
  void report_failure(NodeId node, const std::string& error) {
    wire::NodeReport report;
    report.mutable_scene_light()->set_scene("grotto");
    report.mutable_scene_light()->set_error(error);
    s.state.node_reported(node, report);
  }
  /// Returns the commands about light that a node got since the last call, such as "send light".
  std::vector<std::string> commands(NodeId node) {
    std::vector<std::string> found;
    for (const wire::NodeCommand& command : s.delegate.commands[node]) {
      if (command.has_compute_light()) found.push_back("compute");
      for (const std::uint32_t piece : command.compute_pieces().pieces())
        found.push_back("compute " + std::to_string(command.compute_pieces().stage().number()) + "-" +
                        std::to_string(piece));
      if (command.has_send_piece())
        found.push_back("send piece " + std::to_string(command.send_piece().piece().piece()));
      if (command.has_use_piece()) found.push_back("use piece " + std::to_string(command.use_piece().piece().piece()));
      if (command.has_send_light()) found.push_back("send " + command.send_light().light().version());
      if (command.has_use_light()) found.push_back("use " + command.use_light().light().version());
    }
    std::erase_if(s.delegate.commands[node], [](const wire::NodeCommand& command) { return !command.has_render(); });
    return found;
  }
  void wait(Duration time) {
    s.clock.advance(time);
    s.state.tick();
  }
  /// Renders a moving view and returns the nodes that had blocks of it; all of them must have had the same light.
  std::set<NodeId> move(const std::string& light) {
    s.request_view(session, view_of(++number));
    std::set<NodeId> busy;
    for (const auto& [node, given] : s.delegate.commands) {
      for (const wire::NodeCommand& command : given) {
        if (!command.has_render() || command.render().keep()) continue;  // A picture at rest keeps its own.
        EXPECT_EQ(command.render().view().light(), light);
        EXPECT_EQ(command.render().view().stored_light(), !light.empty());
        busy.insert(node);
      }
    }
    s.clock.advance(std::chrono::milliseconds(10));
    s.settle(nodes);
    return busy;
  }
  std::set<NodeId> move_often(const std::string& light) {
    std::set<NodeId> busy;
    for (int i = 0; i < 30; ++i) busy.merge(move(light));
    return busy;
  }
  /// Lets the picture come to rest and returns the view of the last refined one.
  wire::View rest() {
    for (int i = 0; i < 5; ++i) {
      s.clock.advance(std::chrono::milliseconds(100));
      s.state.tick();
      s.settle(nodes);
    }
    return s.begun.back();
  }

  FarmSimulation s;
  std::vector<NodeId> nodes;
  SessionId session{};
  std::uint64_t number = 0;
  const std::string in_use = version().version();
};

TEST_F(CoordinatorLight, is_computed_by_all_nodes_and_given_to_those_that_lack_it) {
  s.state.tick();
  EXPECT_THAT(commands(nodes[0]), IsEmpty()) << "others may yet report that they have it";
  wait(std::chrono::seconds(4));
  EXPECT_THAT(commands(nodes[0]), ElementsAre("compute"));
  EXPECT_THAT(commands(nodes[1]), ElementsAre("compute"));
  wait(std::chrono::seconds(60));
  EXPECT_THAT(commands(nodes[0]), IsEmpty()) << "once";
  report_light(nodes[0]);
  EXPECT_THAT(commands(nodes[0]), ElementsAre("send " + in_use));
  EXPECT_THAT(s.delegate.accepted_light, ElementsAre(in_use));
  s.state.light_stored(in_use);
  EXPECT_THAT(commands(nodes[1]), ElementsAre("use " + in_use));
  report_light(nodes[1]);
  EXPECT_THAT(move_often(in_use), ElementsAre(nodes[0], nodes[1]));
  EXPECT_THAT(commands(nodes[1]), IsEmpty());
}

TEST_F(CoordinatorLight, is_used_from_the_next_frame_on_when_all_nodes_have_it) {
  move_often("");
  report_light(nodes[0]);
  EXPECT_THAT(move_often(""), ElementsAre(nodes[0], nodes[1])) << "paths until then";
  s.request_view(session, view_of(++number));
  report_light(nodes[1]);
  EXPECT_THAT(s.delegate.notices, Contains(HasSubstr("scene 'grotto' has its light computed")));
  for (const NodeId node : nodes) {
    for (const wire::NodeCommand& command : s.delegate.commands[node]) {
      EXPECT_FALSE(command.has_render() && command.render().view().stored_light()) << "a frame in flight stays";
    }
  }
  s.settle(nodes);
  EXPECT_THAT(move_often(in_use), ElementsAre(nodes[0], nodes[1]));
  EXPECT_EQ(s.given_up, 0);
}

TEST_F(CoordinatorLight, does_not_wait_for_ever_for_a_node_that_does_not_get_it) {
  report_light(nodes[0]);
  wait(std::chrono::seconds(90));
  move("");
  s.state.light_stored(in_use);  // The other one can fetch it only now.
  wait(std::chrono::seconds(30));
  EXPECT_THAT(move_often(in_use), ElementsAre(nodes[0])) << "the other one is left out";
  report_light(nodes[1]);
  EXPECT_THAT(move_often(in_use), ElementsAre(nodes[0], nodes[1]));
}

TEST_F(CoordinatorLight, does_not_wait_for_a_node_that_refuses_it) {
  report_light(nodes[0]);
  s.state.light_stored(in_use);
  report_failure(nodes[1], "this light belongs to another scene");
  EXPECT_THAT(s.delegate.notices, Contains(HasSubstr("its light cannot be used, so paths are traced: this light")));
  EXPECT_THAT(move_often(in_use), ElementsAre(nodes[0]));
  commands(nodes[1]);
  wait(std::chrono::seconds(90));
  EXPECT_THAT(commands(nodes[1]), ElementsAre("use " + in_use)) << "it may have been the network";
  report_failure(nodes[1], "this light belongs to another scene");
  EXPECT_EQ(std::ranges::count_if(s.delegate.notices,
                                  [](const auto& notice) { return notice.find("cannot be used") != notice.npos; }),
            1);
}

TEST_F(CoordinatorLight, never_mixes_with_paths_when_a_node_that_has_it_is_lost_in_a_frame) {
  report_light(nodes[0]);
  s.state.light_stored(in_use);
  wait(std::chrono::seconds(30));
  move(in_use);
  s.request_view(session, view_of(++number));
  const NodeId gone = nodes[0];
  nodes.erase(nodes.begin());
  s.kill(gone);
  for (const wire::NodeCommand& command : s.delegate.commands[nodes[0]]) {
    EXPECT_FALSE(command.has_render() && command.render().view().stored_light());
  }
  s.settle(nodes);
  EXPECT_LE(s.given_up, 2) << "the frames in flight";
  const int given_up = s.given_up;
  move_often("");
  EXPECT_EQ(s.given_up, given_up);
  EXPECT_THAT(s.delegate.notices, Contains(HasSubstr("no node has the computed light of scene 'grotto'")));
}

TEST_F(CoordinatorLight, is_computed_by_another_node_when_the_first_is_killed_or_fails) {
  wait(std::chrono::seconds(4));
  EXPECT_THAT(commands(nodes[0]), ElementsAre("compute"));
  EXPECT_THAT(commands(nodes[1]), ElementsAre("compute"));
  s.kill(nodes[0]);
  report_failure(nodes[1], "its disk is full");
  EXPECT_THAT(s.delegate.notices, Contains(HasSubstr("its light could not be computed ahead, so paths are traced")));
  const NodeId third = s.add_node();
  wait(std::chrono::seconds(4));
  EXPECT_THAT(commands(third), ElementsAre("compute"));
  report_failure(third, "its disk is full");
  wait(std::chrono::seconds(600));
  EXPECT_THAT(commands(third), IsEmpty());
  EXPECT_THAT(commands(nodes[1]), IsEmpty());
  nodes = {nodes[1], third};
  move_often("");
  EXPECT_EQ(s.given_up, 0);
}

TEST_F(CoordinatorLight, is_divided_among_idle_nodes_and_each_gets_what_the_others_computed) {
  wait(std::chrono::seconds(4));
  for (const NodeId node : nodes) commands(node);
  report_pieces(nodes[0], 0, 2, {});
  EXPECT_THAT(commands(nodes[0]), ElementsAre("compute 0-0", "compute 0-1"));
  report_pieces(nodes[1], 0, 2, {});
  EXPECT_THAT(commands(nodes[1]), IsEmpty()) << "all are being computed";
  report_pieces(nodes[0], 0, 2, {0});
  EXPECT_THAT(commands(nodes[0]), ElementsAre("send piece 0"));
  const std::string file = piece_file(0, 0).version();
  EXPECT_THAT(s.delegate.accepted_light, ElementsAre(file));
  s.state.light_stored(file);
  EXPECT_THAT(commands(nodes[1]), ElementsAre("use piece 0"));
  report_pieces(nodes[1], 0, 2, {0});
  wait(std::chrono::seconds(1));
  EXPECT_THAT(s.delegate.forgotten_light, ElementsAre(file)) << "both have it";
  EXPECT_EQ(s.state.overview().sessions[0].light, "paths; 2 nodes compute light");
}

TEST_F(CoordinatorLight, is_not_ordered_from_a_node_that_renders) {
  wait(std::chrono::seconds(4));
  for (const NodeId node : nodes) commands(node);
  s.request_view(session, view_of(++number));
  report_pieces(nodes[0], 0, 2, {});
  EXPECT_THAT(commands(nodes[0]), IsEmpty());
  s.settle(nodes);
  while (!s.delegate.commands[nodes[0]].empty()) s.settle(nodes);
  report_pieces(nodes[0], 0, 2, {});
  EXPECT_THAT(commands(nodes[0]), ElementsAre("compute 0-0", "compute 0-1"));
}

TEST_F(CoordinatorLight, goes_on_where_it_was_when_the_coordinator_was_restarted) {
  wait(std::chrono::seconds(4));
  for (const NodeId node : nodes) EXPECT_THAT(commands(node), ElementsAre("compute")) << "they report what they have";
  report_pieces(nodes[0], 7, 3, {0, 1});
  EXPECT_THAT(commands(nodes[0]), ElementsAre("compute 7-2"));
  report_pieces(nodes[1], 6, 1, {});
  EXPECT_THAT(commands(nodes[1]), ElementsAre("compute 6-0")) << "nobody at that stage is left that could send it";
}

TEST_F(CoordinatorLight, that_is_computed_otherwise_takes_no_part) {
  wait(std::chrono::seconds(4));
  for (const NodeId node : nodes) commands(node);
  report_pieces(nodes[0], 0, 2, {});
  report_pieces(nodes[1], 0, 2, {}, 'b');
  EXPECT_THAT(commands(nodes[1]), IsEmpty());
  EXPECT_THAT(s.delegate.notices, Contains(HasSubstr("it takes no part")));
  s.kill(nodes[0]);
  wait(std::chrono::seconds(300));
  EXPECT_THAT(commands(nodes[1]), ElementsAre("compute")) << "it is alone now, so it reports its stage once more";
  report_pieces(nodes[1], 0, 2, {}, 'b');
  EXPECT_THAT(commands(nodes[1]), ElementsAre("compute 0-0", "compute 0-1"));
}

TEST_F(CoordinatorLight, of_a_scene_that_was_replaced_is_given_up) {
  wait(std::chrono::seconds(4));
  for (const NodeId node : nodes) commands(node);
  report_pieces(nodes[0], 0, 2, {});
  wire::NodeReport dropped;
  dropped.mutable_scene_dropped()->set_scene("grotto");
  for (const NodeId node : nodes) s.state.node_reported(node, dropped);
  report_pieces(nodes[0], 0, 2, {0, 1});
  for (const NodeId node : nodes) {
    const std::vector<std::string> given = commands(node);
    EXPECT_EQ(std::ranges::count_if(given, [](const auto& c) { return c.find("compute") == 0; }),
              node == nodes[0] ? 2 : 0);
  }
}

TEST_F(CoordinatorLight, of_broken_pieces_ends_the_node) {
  wait(std::chrono::seconds(4));
  report_pieces(nodes[0], 0, 2, {5});
  EXPECT_TRUE(s.delegate.ended_nodes.contains(nodes[0]));
  report_pieces(nodes[1], 0, 100'000, {});
  EXPECT_TRUE(s.delegate.ended_nodes.contains(nodes[1]));
}

TEST_F(CoordinatorLight, comes_from_another_node_when_the_sender_is_lost_or_silent) {
  const NodeId third = s.add_node();
  report_light(nodes[0]);
  report_light(nodes[1]);
  EXPECT_THAT(commands(nodes[0]), ElementsAre("send " + in_use));
  wait(std::chrono::seconds(90));
  EXPECT_THAT(commands(nodes[1]), ElementsAre("send " + in_use));
  EXPECT_THAT(commands(third), IsEmpty());
  s.kill(nodes[1]);
  EXPECT_THAT(commands(nodes[0]), ElementsAre("send " + in_use));
  s.state.light_stored(in_use);
  EXPECT_THAT(commands(third), ElementsAre("use " + in_use));
}

TEST_F(CoordinatorLight, of_several_versions_is_that_of_most_nodes) {
  const NodeId third = s.add_node();
  report_light(third, version("other"));
  report_light(nodes[1]);
  report_light(nodes[0]);
  nodes.push_back(third);
  EXPECT_THAT(commands(third), ElementsAre("send " + version("other").version())) << "the first that was known";
  s.kill(third);
  nodes.pop_back();
  EXPECT_THAT(move_often(in_use), ElementsAre(nodes[0], nodes[1]));
}

TEST_F(CoordinatorLight, with_which_a_picture_at_rest_began_stays_when_another_version_comes) {
  report_light(nodes[0]);
  report_light(nodes[1]);
  move_often(in_use);
  const wire::View resting = rest();
  EXPECT_EQ(resting.light(), in_use);
  EXPECT_EQ(resting.prior_samples(), 4u);
  EXPECT_GT(resting.prior_weight(), 1.0f);
  EXPECT_FALSE(resting.stored_light());
  EXPECT_GT(resting.first_sample(), 0u);
  const std::uint32_t before = resting.first_sample() + resting.samples();
  for (const NodeId node : nodes) report_light(node, version("other"));
  const wire::View later = rest();
  EXPECT_EQ(later.light(), in_use);
  EXPECT_GE(later.first_sample() + later.samples(), before) << "it does not begin anew";
}

TEST_F(CoordinatorLight, lets_a_picture_at_rest_of_paths_go_on) {
  move_often("");
  const wire::View resting = rest();
  EXPECT_EQ(resting.prior_samples(), 0u);
  for (const NodeId node : nodes) report_light(node);
  const wire::View later = rest();
  EXPECT_EQ(later.prior_samples(), 0u);
  EXPECT_GE(later.first_sample() + later.samples(), resting.first_sample() + resting.samples());
  move(in_use);
}

TEST_F(CoordinatorLight, with_which_a_picture_at_rest_began_is_left_out_when_it_is_gone) {
  report_light(nodes[0]);
  s.state.light_stored(in_use);
  wait(std::chrono::seconds(30));
  move_often(in_use);
  EXPECT_EQ(rest().prior_samples(), 4u);
  s.kill(nodes[0]);
  nodes.erase(nodes.begin());
  const wire::View later = rest();
  EXPECT_EQ(later.prior_samples(), 0u);
  EXPECT_EQ(later.light(), "");
}

TEST_F(CoordinatorLight, is_what_the_farm_says_whatever_a_museum_requests) {
  const SessionId other = s.add_session();
  drain_opened(s, other);
  wire::View view = view_of(1);
  view.set_stored_light(true);
  view.set_light("nonsense");
  view.set_prior_samples(9);
  s.request_view(other, view);
  s.settle(nodes);
  EXPECT_FALSE(s.begun.back().stored_light()) << "there is none";
  EXPECT_EQ(s.begun.back().light(), "");
  EXPECT_EQ(s.begun.back().prior_samples(), 0u);
  for (const NodeId node : nodes) report_light(node);
  view.set_number(2);
  s.request_view(other, view);
  s.settle(nodes);
  EXPECT_TRUE(s.begun.back().stored_light());
  EXPECT_EQ(s.begun.back().light(), in_use);
}

TEST_F(CoordinatorLight, of_a_broken_version_ends_the_node) {
  wire::LightVersion wrong;
  wrong.set_version("../light");
  report_light(nodes[0], wrong);
  EXPECT_EQ(s.delegate.ended_nodes.size(), 1u);
}

TEST_F(CoordinatorLight, is_shown_for_each_session_and_node) {
  wire::NodeReport report;
  wire::LightProgress& progress = *report.mutable_status()->add_light();
  progress.set_scene("grotto");
  progress.set_done_share(0.42);
  progress.set_seconds_left(150.0);
  s.state.node_reported(nodes[1], report);
  wait(std::chrono::seconds(4));
  watch::FarmOverview farm = s.state.overview();
  EXPECT_THAT(farm.nodes[0].light, ElementsAre());
  EXPECT_THAT(farm.nodes[1].light, ElementsAre("grotto: 42 %, 3 min left"));
  EXPECT_EQ(farm.sessions[0].light, "paths; 2 nodes compute light");
  s.state.node_reported(nodes[1], [] {
    wire::NodeReport done;
    done.mutable_status();
    return done;
  }());
  report_light(nodes[1]);
  EXPECT_EQ(s.state.overview().sessions[0].light, "paths; light is being given to the nodes");
  report_light(nodes[0]);
  farm = s.state.overview();
  EXPECT_EQ(farm.sessions[0].light, "light " + short_version(in_use) + " on 2 of 2 nodes");
  EXPECT_THAT(farm.nodes[1].light, ElementsAre("grotto: " + short_version(in_use)));
}

}  // namespace
}  // namespace cyclorama::coordinator
