// SPDX-License-Identifier: Apache-2.0
// Scenes that are on the coordinator's disk.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderfarm/coordinator/coordinator_state.h"
#include "tests/doubles/fake_clock.h"
#include "tests/doubles/recording_delegate.h"

namespace cyclorama::coordinator {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class CoordinatorScenes : public testing::Test {
 protected:
  NodeId add_node() {
    const NodeId id{++last_id_};
    state.node_connected(id);
    wire::NodeReport report;
    report.mutable_hello()->set_version(CYCLORAMA_VERSION);
    report.mutable_hello()->set_threads(1);
    state.node_reported(id, report);
    return id;
  }
  /// Returns "name path digest" of each scene that a node was ordered to load.
  std::vector<std::string> orders(NodeId node) {
    std::vector<std::string> texts;
    for (const wire::NodeCommand& command : delegate.commands[node]) {
      const wire::LoadScene& load = command.load_scene();
      texts.push_back(load.scene() + " " + load.path() + " " + load.digest());
    }
    return texts;
  }

  FakeClock clock;
  RecordingDelegate delegate;
  const std::string digest = std::string(64, 'd');
  CoordinatorState state{{{"own", "/nodes/own"}, {"shared", "/coordinator/shared", true}},
                         balance::BalanceStrategy::kEqual,
                         CoordinatorLimits{},
                         clock,
                         delegate};

 private:
  std::uint64_t last_id_ = 0;
};

TEST_F(CoordinatorScenes, are_loaded_by_digest_once_they_were_read_and_never_by_path) {
  const NodeId early = add_node();
  const NodeId unauthenticated{100};
  state.node_connected(unauthenticated);
  EXPECT_THAT(orders(early), ElementsAre("own /nodes/own "));
  state.scene_read("shared", digest);
  EXPECT_THAT(orders(early), ElementsAre("own /nodes/own ", "shared  " + digest));
  EXPECT_THAT(orders(unauthenticated), ElementsAre());
  EXPECT_THAT(orders(add_node()), ElementsAre("own /nodes/own ", "shared  " + digest));
}

TEST_F(CoordinatorScenes, are_reported_as_being_read) {
  add_node();
  const SessionId session{1};
  state.session_connected(session);
  wire::SessionRequest request;
  request.mutable_open()->set_scene("shared");
  state.session_requested(session, request, clock.now());
  ASSERT_TRUE(delegate.ended_sessions.contains(session));
  EXPECT_EQ(delegate.ended_sessions.at(session).code(), ErrorCode::kUnavailable);
  EXPECT_THAT(delegate.ended_sessions.at(session).message(), HasSubstr("still reading its files"));
}

TEST_F(CoordinatorScenes, a_node_that_loaded_one_without_a_command_is_disconnected) {
  const NodeId node = add_node();
  wire::NodeReport report;
  report.mutable_scene_loaded()->set_scene("shared");
  state.node_reported(node, report);
  EXPECT_TRUE(delegate.ended_nodes.contains(node));
}

}  // namespace
}  // namespace cyclorama::coordinator
