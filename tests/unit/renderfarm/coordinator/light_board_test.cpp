// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/light_board.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "renderfarm/scene_distribution/sha256.h"

namespace cyclorama::coordinator {
namespace {

using testing::IsEmpty;

constexpr std::uint32_t kStages = 4;
constexpr std::uint32_t kPieces = 40;

std::string key_of(std::uint32_t stage) { return std::string(31, '0') + static_cast<char>('0' + stage % 10); }
std::string file_of(std::uint32_t stage, std::uint32_t piece) {
  return scene_distribution::sha256_of(std::to_string(stage) + "-" + std::to_string(piece));
}

wire::LightPieces report_of(std::uint32_t stage, const std::set<std::uint32_t>& pieces) {
  wire::LightPieces report;
  report.mutable_stage()->set_number(stage);
  report.mutable_stage()->set_key(key_of(stage));
  report.mutable_stage()->set_pieces(kPieces);
  for (const std::uint32_t piece : pieces) {
    wire::LightPiece& taken = *report.add_pieces();
    taken.set_piece(piece);
    taken.mutable_file()->set_version(file_of(stage, piece));
    taken.mutable_file()->set_bytes(1000);
  }
  return report;
}

/// Nodes that compute what they are ordered to, one piece a round; orders and files may be lost.
class BoardSimulation {
 public:
  struct FakeNode {
    bool is_busy = false;
    std::uint32_t stage = 0;
    std::set<std::uint32_t> ordered{};
    std::map<std::uint32_t, std::set<std::uint32_t>> has{};  ///< Pieces by stage; they survive the node's death.
  };

  void come(std::uint64_t id) {
    FakeNode& node = nodes[NodeId{id}];
    node.stage = 0;
    enter(NodeId{id}, node);
  }
  void kill(std::uint64_t id) {
    board.leave(NodeId{id});
    gone[NodeId{id}] = nodes[NodeId{id}];
    nodes.erase(NodeId{id});
  }
  void come_back(std::uint64_t id) {
    nodes[NodeId{id}] = gone[NodeId{id}];
    nodes[NodeId{id}].ordered.clear();
    come(id);
  }
  void round() {
    now += std::chrono::seconds(1);
    LightBoard::Orders orders = board.next(now, [&](NodeId id) { return !nodes.at(id).is_busy; });
    files -= orders.unneeded.size();
    for (const auto& [id, order] : orders.compute) {
      EXPECT_FALSE(nodes.at(id).is_busy);
      for (const std::uint32_t piece : order.pieces()) {
        if (!is_lost() && order.stage().number() == nodes.at(id).stage) nodes.at(id).ordered.insert(piece);
      }
    }
    for (const auto& [id, order] : orders.send) {
      EXPECT_TRUE(nodes.at(id).has[order.stage().number()].contains(order.piece().piece()));
      ++files;
      if (!is_unreachable && !is_lost()) board.stored(order.piece().file().version());
    }
    max_files = std::max(max_files, files);
    for (const auto& [id, order] : orders.use) {
      if (!is_lost()) take(id, order.stage().number(), order.piece().piece());
    }
    for (auto& [id, node] : nodes) {
      if (node.is_busy || node.ordered.empty()) continue;
      EXPECT_LE(node.ordered.size(), LightBoard::kOrdered) << "at a time";
      const std::uint32_t piece = *node.ordered.begin();
      node.ordered.erase(piece);
      computed += node.has[node.stage].contains(piece) ? 0 : 1;
      take(id, node.stage, piece);
    }
  }
  [[nodiscard]] bool is_done() const {
    return std::ranges::all_of(nodes, [](const auto& entry) { return entry.second.stage == kStages; });
  }
  /// Returns the rounds until all nodes are done, or a large number.
  int finish() {
    int rounds = 0;
    while (!is_done() && rounds < 5000) {
      round();
      ++rounds;
    }
    return rounds;
  }

  LightBoard board;
  std::map<NodeId, FakeNode> nodes;
  std::map<NodeId, FakeNode> gone;
  TimePoint now{};
  double loss = 0.0;
  bool is_unreachable = false;  ///< No file arrives at the coordinator.
  int computed = 0;
  std::size_t files = 0;
  std::size_t max_files = 0;

 private:
  bool is_lost() { return std::uniform_real_distribution(0.0, 1.0)(random_) < loss; }
  void take(NodeId id, std::uint32_t stage, std::uint32_t piece) {
    FakeNode& node = nodes.at(id);
    node.has[stage].insert(piece);
    if (stage != node.stage) return;
    EXPECT_TRUE(*board.report(id, report_of(stage, {piece})));
    if (node.has[stage].size() < kPieces) return;
    ++node.stage;
    node.ordered.clear();
    if (node.stage < kStages) enter(id, node);
  }
  void enter(NodeId id, FakeNode& node) {
    EXPECT_TRUE(*board.report(id, report_of(node.stage, node.has[node.stage])));
    if (node.has[node.stage].size() < kPieces) return;
    if (++node.stage < kStages) enter(id, node);
  }

  std::mt19937 random_{7};
};

TEST(LightBoard, has_each_piece_computed_once) {
  BoardSimulation s;
  for (std::uint64_t id = 1; id <= 4; ++id) s.come(id);
  const int rounds = s.finish();
  EXPECT_EQ(s.computed, kStages * kPieces);
  EXPECT_LT(rounds, 2 * static_cast<int>(kStages * kPieces) / 4) << "nodes work at the same time";
  EXPECT_LE(s.max_files, LightBoard::kMaxFiles);
}

TEST(LightBoard, sends_no_files_while_a_node_is_alone) {
  BoardSimulation s;
  s.come(1);
  EXPECT_LT(s.finish(), 2 * static_cast<int>(kStages * kPieces));
  EXPECT_EQ(s.max_files, 0u);
}

TEST(LightBoard, completes_although_orders_and_files_are_lost) {
  BoardSimulation s;
  s.loss = 0.3;
  for (std::uint64_t id = 1; id <= 3; ++id) s.come(id);
  s.finish();
  EXPECT_TRUE(s.is_done());
}

TEST(LightBoard, lets_each_node_compute_everything_when_no_file_can_be_sent) {
  BoardSimulation s;
  s.is_unreachable = true;
  s.come(1);
  s.come(2);
  s.finish();
  EXPECT_TRUE(s.is_done());
}

TEST(LightBoard, loses_only_what_a_killed_node_alone_had) {
  BoardSimulation s;
  for (std::uint64_t id = 1; id <= 3; ++id) s.come(id);
  for (int i = 0; i < 30; ++i) s.round();
  s.kill(2);
  for (int i = 0; i < 10; ++i) s.round();
  s.come_back(2);
  s.finish();
  EXPECT_TRUE(s.is_done());
  EXPECT_LE(s.computed, static_cast<int>(std::size_t{kStages} * kPieces + 3 * LightBoard::kOrdered));
}

TEST(LightBoard, gives_a_node_that_comes_late_what_there_is) {
  BoardSimulation s;
  s.come(1);
  for (int i = 0; i < 100; ++i) s.round();
  s.come(2);
  s.finish();
  EXPECT_TRUE(s.is_done());
  EXPECT_LE(s.computed, static_cast<int>(std::size_t{kStages} * kPieces + LightBoard::kOrdered));
}

TEST(LightBoard, lets_an_idle_node_compute_what_a_busy_one_was_ordered_to) {
  BoardSimulation s;
  s.come(1);
  s.come(2);
  s.round();
  s.nodes[NodeId{1}].is_busy = true;
  for (int i = 0; i < 300; ++i) s.round();
  EXPECT_EQ(s.nodes[NodeId{2}].stage, kStages);
  EXPECT_EQ(s.nodes[NodeId{1}].stage, kStages) << "it got all results without computing any";
}

TEST(LightBoard, forgets_another_computation_once_its_nodes_are_gone) {
  LightBoard board;
  EXPECT_TRUE(*board.report(NodeId{1}, report_of(0, {0})));
  wire::LightPieces other = report_of(0, {});
  other.mutable_stage()->set_key(std::string(32, 'f'));
  EXPECT_FALSE(*board.report(NodeId{2}, other));
  EXPECT_FALSE(board.has(NodeId{2}));
  board.leave(NodeId{1});
  EXPECT_TRUE(*board.report(NodeId{2}, other));
  const auto orders = board.next(TimePoint{}, [](NodeId) { return true; });
  EXPECT_EQ(orders.compute.at(NodeId{2}).stage().key(), std::string(32, 'f'));
  EXPECT_THAT(orders.send, IsEmpty());
}

TEST(LightBoard, refuses_broken_reports) {
  LightBoard board;
  for (const auto spoil : {+[](wire::LightPieces* r) { r->mutable_stage()->set_key("../../etc/passwd"); },
                           +[](wire::LightPieces* r) { r->mutable_stage()->set_pieces(0); },
                           +[](wire::LightPieces* r) { r->mutable_stage()->set_pieces(257); },
                           +[](wire::LightPieces* r) { r->mutable_stage()->set_number(1u << 31); },
                           +[](wire::LightPieces* r) { r->mutable_pieces(0)->set_piece(kPieces); },
                           +[](wire::LightPieces* r) { r->mutable_pieces(0)->mutable_file()->set_version("x"); },
                           +[](wire::LightPieces* r) { r->mutable_pieces(0)->mutable_file()->set_bytes(~0ull); }}) {
    wire::LightPieces report = report_of(0, {1});
    spoil(&report);
    EXPECT_FALSE(board.report(NodeId{1}, report).has_value());
  }
}

}  // namespace
}  // namespace cyclorama::coordinator
