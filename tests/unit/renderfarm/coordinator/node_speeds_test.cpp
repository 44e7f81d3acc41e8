// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/node_speeds.h"

#include <gtest/gtest.h>

#include <limits>

namespace cyclorama::coordinator {
namespace {

constexpr TimePoint kNow{std::chrono::hours(1)};

wire::SceneLoaded loaded(double probe_seconds) {
  wire::SceneLoaded message;
  message.set_scene("cave");
  message.set_probe_cpu_seconds(probe_seconds);
  return message;
}

wire::BlockEnd block_end(double cpu_seconds, double wall_seconds) {
  wire::BlockEnd end;
  end.set_render_cpu_seconds(cpu_seconds);
  end.set_wall_seconds(wall_seconds);
  return end;
}

NodeTable three_nodes() {
  NodeTable nodes;
  for (const std::uint64_t id : {1u, 2u, 3u}) {
    nodes.add(NodeId{id}, kNow);
    nodes.at(NodeId{id}).threads = 4.0;
    nodes.at(NodeId{id}).scenes["cave"].state = Node::SceneState::kLoaded;
  }
  return nodes;
}

TEST(NodeSpeeds, are_relative_to_the_first_node_and_equal_for_hosts_of_a_kind) {
  NodeSpeeds speeds;
  EXPECT_EQ(speeds.relative(loaded(2.0)), 1.0);
  EXPECT_EQ(speeds.relative(loaded(1.0)), 2.0);
  EXPECT_EQ(speeds.relative(loaded(1.9)), 1.0);
  EXPECT_EQ(speeds.relative(loaded(1e9)), 0.01);
  for (const double none : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(speeds.relative(loaded(none)), 1.0);
  }
}

TEST(NodeSpeeds, count_a_node_as_slowed_only_if_it_waits_far_more_than_the_others) {
  NodeTable nodes = three_nodes();
  NodeSpeeds speeds;
  Node& slow = nodes.at(NodeId{3});
  for (auto& [id, node] : nodes) NodeSpeeds::learn(&node, block_end(3.2, 1.0), kNow);
  speeds.compare("cave", &nodes, kNow);
  EXPECT_EQ(speeds.of(slow, "cave"), 4.0);
  EXPECT_NEAR(speeds.wall_speed_of(slow, "cave"), 3.2, 1e-9) << "all of them wait a little";
  for (int i = 0; i < 40; ++i) NodeSpeeds::learn(&slow, block_end(0.8, 1.0), kNow);
  speeds.compare("cave", &nodes, kNow);
  EXPECT_NEAR(speeds.of(slow, "cave"), 1.0, 0.1);
  EXPECT_EQ(speeds.of(nodes.at(NodeId{1}), "cave"), 4.0);
}

TEST(NodeSpeeds, try_a_slowed_node_again_that_was_not_measured_for_a_while) {
  NodeTable nodes = three_nodes();
  NodeSpeeds speeds;
  Node& slow = nodes.at(NodeId{3});
  NodeSpeeds::learn(&slow, block_end(0.4, 1.0), kNow);
  speeds.compare("cave", &nodes, kNow);
  const double before = slow.utilisation;
  for (int second = 2; second < 12; ++second) speeds.compare("cave", &nodes, kNow + std::chrono::seconds(second));
  EXPECT_GT(slow.utilisation, 2.0 * before);
  EXPECT_EQ(nodes.at(NodeId{1}).utilisation, 1.0);
}

TEST(NodeSpeeds, ignore_impossible_measurements) {
  NodeTable nodes = three_nodes();
  Node& node = nodes.at(NodeId{1});
  for (const auto& [cpu, wall] : {std::pair{1.0, 0.0}, {1.0, -1.0}, {-1.0, 1.0}, {1e9, 1.0}, {1.0, 1e9}}) {
    NodeSpeeds::learn(&node, block_end(cpu, wall), kNow);
    EXPECT_EQ(node.utilisation, 1.0);
  }
  NodeSpeeds::learn(&node, block_end(100.0, 1.0), kNow);
  EXPECT_EQ(node.utilisation, 1.0) << "no node has more than all of its threads";
}

}  // namespace
}  // namespace cyclorama::coordinator
