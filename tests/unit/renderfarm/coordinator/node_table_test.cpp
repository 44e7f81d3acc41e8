// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/node_table.h"

#include <gtest/gtest.h>

namespace cyclorama::coordinator {
namespace {

constexpr TimePoint kNow{std::chrono::hours(1)};
constexpr AccountId kAccount{1};

Node& add_node(NodeTable& nodes, std::uint64_t id, double threads = 4.0) {
  nodes.add(NodeId{id}, kNow);
  Node& node = nodes.at(NodeId{id});
  node.threads = threads;
  node.scenes["cave"].state = Node::SceneState::kLoaded;
  return node;
}

std::vector<NodeId> ids(std::initializer_list<std::uint64_t> numbers) {
  std::vector<NodeId> out;
  for (const std::uint64_t number : numbers) out.push_back(NodeId{number});
  return out;
}

TEST(NodeTable, returns_what_it_knew_of_a_node_that_is_removed_and_nothing_of_an_unknown_one) {
  NodeTable nodes;
  EXPECT_TRUE(nodes.empty());
  add_node(nodes, 1).name = "first";
  EXPECT_EQ(nodes.at(NodeId{1}).arrived_at, kNow);
  const auto removed = nodes.remove(NodeId{1});
  ASSERT_TRUE(removed.has_value());
  EXPECT_EQ(removed->name, "first");
  EXPECT_FALSE(nodes.remove(NodeId{1}).has_value());
  EXPECT_EQ(nodes.size(), 0u);
}

TEST(NodeTable, leaves_out_nodes_that_are_late_or_stop_while_there_are_others) {
  NodeTable nodes;
  for (const std::uint64_t id : {1u, 2u, 3u, 4u}) add_node(nodes, id);
  EXPECT_EQ(nodes.able("cave", kAccount, ""), ids({1, 2, 3, 4}));
  nodes.at(NodeId{1}).late_for = {kAccount};
  nodes.at(NodeId{2}).status.set_draining(true);
  nodes.at(NodeId{3}).late_for = {AccountId{2}};
  EXPECT_EQ(nodes.able("cave", kAccount, ""), ids({3, 4})) << "node 3 is late for another account alone";
  EXPECT_EQ(nodes.able("cave", kAccount, "", NodeId{4}), ids({3}));
  nodes.at(NodeId{3}).late_for = {AccountId{2}, AccountId{3}};
  nodes.remove(NodeId{4});
  EXPECT_EQ(nodes.able("cave", kAccount, ""), ids({1, 2, 3})) << "there is no better one";
  EXPECT_EQ(nodes.able("hall", kAccount, ""), ids({}));
}

TEST(NodeTable, knows_the_nodes_that_have_a_scene_and_a_version_of_its_light) {
  NodeTable nodes;
  add_node(nodes, 1).scenes["cave"].memory_bytes = 5;
  add_node(nodes, 2).scenes["cave"].memory_bytes = 7;
  add_node(nodes, 3).scenes["cave"] = {.state = Node::SceneState::kLoading, .memory_bytes = 9};
  EXPECT_EQ(nodes.count_with("cave"), 2u);
  EXPECT_EQ(nodes.memory_of("cave"), 7u);
  EXPECT_EQ(nodes.memory_of("hall"), 0u);
  nodes.at(NodeId{2}).scenes["cave"].light.emplace_back().set_version("abc");
  EXPECT_EQ(nodes.able("cave", kAccount, "abc"), ids({2}));
}

TEST(NodeTable, compares_blocks_by_the_threads_of_their_nodes) {
  NodeTable nodes;
  add_node(nodes, 1, 2.0).blocks[10] = {};
  Node& large = add_node(nodes, 2, 8.0);
  for (const std::uint64_t block : {11u, 12u, 13u}) large.blocks[block] = {};
  EXPECT_EQ(nodes.least_loaded(ids({1, 2})), NodeId{2});
  EXPECT_EQ(nodes.threads_of({NodeId{1}, NodeId{2}}), 10.0);
  EXPECT_EQ(nodes.capacity(), 10.0);
  large.utilisation = 0.5;
  EXPECT_EQ(nodes.capacity(), 6.0) << "its host gives it half of the time";
}

}  // namespace
}  // namespace cyclorama::coordinator
