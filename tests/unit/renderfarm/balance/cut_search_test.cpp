// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/balance/cut_search.h"

#include <gtest/gtest.h>

#include "renderfarm/balance/levelling.h"

namespace cyclorama::balance {
namespace {

TEST(WorkSums, sum_any_rectangle) {
  WorkGrid work({48, 32});
  float value = 1.0f;
  for (float& cell : work.cells()) cell = value++;  // 1 2 3 / 4 5 6
  const WorkSums sums(work);
  EXPECT_DOUBLE_EQ(sums.of({0, 0, 3, 2}), 21.0);
  EXPECT_DOUBLE_EQ(sums.of({1, 0, 1, 2}), 7.0);
  EXPECT_DOUBLE_EQ(sums.of({2, 1, 1, 1}), 6.0);
  EXPECT_DOUBLE_EQ(sums.of({1, 1, 0, 1}), 0.0);
}

TEST(WorkSums, find_the_cut_with_the_nearest_work) {
  WorkGrid work({80, 16});
  for (float& cell : work.cells()) cell = 1.0f;
  const WorkSums sums(work);
  EXPECT_EQ(nearest_cut(sums, {0, 0, 5, 1}, CutDirection::kAcross, 2.4), 2);
  EXPECT_EQ(nearest_cut(sums, {0, 0, 5, 1}, CutDirection::kAcross, 2.6), 3);
  EXPECT_EQ(nearest_cut(sums, {0, 0, 5, 1}, CutDirection::kAcross, 0.0), 1);
  EXPECT_EQ(nearest_cut(sums, {0, 0, 5, 1}, CutDirection::kAcross, 99.0), 4);
}

TEST(CutSearch, cuts_where_both_sides_finish_at_once) {
  WorkGrid work({160, 32}, 1.0f);
  const std::vector<double> speeds{1.0, 4.0};
  const auto parts = cut_for_nodes(WorkSums(work), speeds);
  EXPECT_EQ(parts[0], (CellRect{0, 0, 2, 2}));
  EXPECT_EQ(parts[1], (CellRect{2, 0, 8, 2}));
}

TEST(CutSearch, cuts_the_shorter_side_if_only_that_is_balanced) {
  // Four cells wide and three high: the last column has nearly all the work, in its two upper cells.
  WorkGrid work({64, 48}, 0.01f);
  work.at(3, 0) = work.at(3, 1) = 10.0f;
  const std::vector<double> speeds{1.0, 1.0};
  EXPECT_EQ(cut_for_nodes(WorkSums(work), speeds)[0], (CellRect{0, 0, 4, 1}));
}

TEST(CutSearch, looks_one_level_ahead) {
  // A cut between the columns gives both sides equal work, but a side whose work lies in one cell cannot be divided
  // between two.
  WorkGrid work({64, 64}, 0.001f);
  work.at(0, 0) = work.at(1, 0) = work.at(2, 0) = work.at(3, 0) = 1.0f;
  const std::vector<double> speeds(4, 1.0);
  const auto parts = cut_for_nodes(WorkSums(work), speeds);
  for (const CellRect& part : parts) EXPECT_NEAR(WorkSums(work).of(part), 1.0, 0.05);
}

TEST(CutSearch, gives_nodes_compact_shares) {
  const WorkSums work(WorkGrid({320, 320}, 1.0f));
  const std::vector<double> shares{0.8, 0.1, 0.06, 0.04};
  const auto parts = cut_by_shares(work, work.whole(), shares);
  ASSERT_EQ(parts.size(), 4u);
  double sum = 0.0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    EXPECT_NEAR(work.of(parts[i]) / 400.0, shares[i], 0.01);
    EXPECT_LE(std::max(parts[i].width, parts[i].height), 4 * std::min(parts[i].width, parts[i].height));
    sum += work.of(parts[i]);
  }
  EXPECT_DOUBLE_EQ(sum, 400.0);
  EXPECT_EQ(cut_by_shares(work, {3, 4, 1, 1}, shares), (std::vector{CellRect{3, 4, 1, 1}}));
  EXPECT_EQ(cut_by_shares(work, {3, 4, 2, 1}, shares).size(), 2u);
}

TEST(Levelling, moves_work_from_the_most_to_the_least_loaded_node) {
  const std::vector<NodeQueue> nodes{
      {1.0, {{5.0, false}, {2.0, true}, {1.0, true}}}, {1.0, {{6.0, false}, {0.5, true}}}, {2.0, {{8.0, false}}}};
  const auto moves = level(nodes, 0.0);
  // Loads 8, 6.5, 4: the first gives its 2 (6, 6.5, 5), the second its 0.5 (6, 6, 5.25). Then the second has nothing
  // left to give.
  ASSERT_EQ(moves.size(), 2u);
  EXPECT_EQ(moves[0].from, 0u);
  EXPECT_EQ(moves[0].block, 1u);
  EXPECT_EQ(moves[0].to, 2u);
  EXPECT_EQ(moves[1].from, 1u);
  EXPECT_EQ(moves[1].to, 2u);
}

TEST(Levelling, moves_nothing_that_is_not_worth_the_overhead) {
  const std::vector<NodeQueue> nodes{{1.0, {{5.0, false}, {0.4, true}}}, {1.0, {{5.0, false}}}};
  EXPECT_TRUE(level(nodes, 0.1).empty());
  EXPECT_TRUE(level({}, 0.0).empty());
  EXPECT_TRUE(level(std::span(nodes).first(1), 0.0).empty());
}

}  // namespace
}  // namespace cyclorama::balance
