// SPDX-License-Identifier: Apache-2.0
// HeadState's scenes that are on the head's disk.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderfarm/coordinator/coordinator_state.h"
#include "tests/doubles/fake_peers.h"

namespace cyclorama {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class HeadScenes : public testing::Test {
 protected:
  NodeId add_node() {
    const NodeId id{++last_id_};
    state.node_came(id);
    wire::NodeReport report;
    report.mutable_hello()->set_version(CYCLORAMA_VERSION);
    report.mutable_hello()->set_threads(1);
    state.node_reported(id, report);
    return id;
  }
  /// "name path digest" of what a node was told to load.
  std::vector<std::string> orders(NodeId node) {
    std::vector<std::string> texts;
    for (const wire::NodeCommand& command : peers.commands[node]) {
      const wire::LoadScene& load = command.load_scene();
      texts.push_back(load.scene() + " " + load.path() + " " + load.digest());
    }
    return texts;
  }

  FakeClock clock;
  FakePeers peers;
  const std::string digest = std::string(64, 'd');
  HeadState state{
      {{"own", "/nodes/own"}, {"shared", "/head/shared", true}}, BalanceStrategy::kEqual, HeadLimits{}, clock, peers};

 private:
  std::uint64_t last_id_ = 0;
};

TEST_F(HeadScenes, are_ordered_by_digest_once_they_were_read_and_never_by_path) {
  const NodeId early = add_node();
  const NodeId stranger{100};
  state.node_came(stranger);
  EXPECT_THAT(orders(early), ElementsAre("own /nodes/own "));
  state.scene_read("shared", digest);
  EXPECT_THAT(orders(early), ElementsAre("own /nodes/own ", "shared  " + digest));
  EXPECT_THAT(orders(stranger), ElementsAre());
  EXPECT_THAT(orders(add_node()), ElementsAre("own /nodes/own ", "shared  " + digest));
}

TEST_F(HeadScenes, that_are_still_being_read_are_said_to_be) {
  add_node();
  const SessionId visit{1};
  state.visit_came(visit);
  wire::VisitRequest request;
  request.mutable_open()->set_scene("shared");
  state.visit_asked(visit, request, clock.now());
  ASSERT_TRUE(peers.ended_visits.contains(visit));
  EXPECT_EQ(peers.ended_visits.at(visit).code(), ErrorCode::kUnavailable);
  EXPECT_THAT(peers.ended_visits.at(visit).message(), HasSubstr("still reading its files"));
}

TEST_F(HeadScenes, of_which_a_node_says_that_it_loaded_one_unasked_end_its_stream) {
  const NodeId node = add_node();
  wire::NodeReport report;
  report.mutable_scene_loaded()->set_scene("shared");
  state.node_reported(node, report);
  EXPECT_TRUE(peers.ended_nodes.contains(node));
}

}  // namespace
}  // namespace cyclorama
