// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/frame_assembly.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "renderfarm/balance/tiles.h"

namespace cyclorama::coordinator {
namespace {

constexpr NodeId kA{1};
constexpr NodeId kB{2};
constexpr PixelRect kLeft{0, 0, 512, 256};
constexpr PixelRect kRight{512, 0, 256, 256};
using Verdict = FrameAssembly::Verdict;

FrameAssembly planned() {
  FrameAssembly frame;
  frame.plan(1, kA, kLeft);
  frame.plan(2, kB, kRight);
  return frame;
}

wire::BlockEnd end_of(double cpu_seconds) {
  wire::BlockEnd end;
  end.set_render_cpu_seconds(cpu_seconds);
  end.set_wall_seconds(cpu_seconds / 2.0);
  end.set_rays(100);
  return end;
}

TEST(FrameAssembly, is_complete_when_all_tiles_and_ends_have_arrived) {
  FrameAssembly frame = planned();
  for (const PixelRect& tile : balance::tiles_of(kLeft)) EXPECT_EQ(frame.accept(1, tile), Verdict::kNew);
  frame.end(1, end_of(2.0));
  EXPECT_EQ(frame.accept(2, kRight), Verdict::kNew);
  EXPECT_FALSE(frame.is_missing_tiles());
  EXPECT_FALSE(frame.is_complete());
  frame.end(2, end_of(1.0));
  EXPECT_TRUE(frame.is_complete());
  EXPECT_EQ(frame.delivered(), 3u);
  const auto sum = frame.summary();
  EXPECT_DOUBLE_EQ(sum.render_seconds, 1.0);
  EXPECT_DOUBLE_EQ(sum.cpu_seconds, 3.0);
  EXPECT_DOUBLE_EQ(sum.loads.at(kA), 2.0);
  EXPECT_EQ(sum.rays, 200u);
}

TEST(FrameAssembly, distinguishes_new_duplicate_and_foreign_tiles) {
  FrameAssembly frame = planned();
  const PixelRect tile = balance::tiles_of(kLeft).front();
  EXPECT_EQ(frame.accept(1, tile), Verdict::kNew);
  EXPECT_EQ(frame.accept(1, tile), Verdict::kDuplicate);
  EXPECT_EQ(frame.accept(2, tile), Verdict::kForeign);
  EXPECT_EQ(frame.accept(9, tile), Verdict::kForeign);
  EXPECT_EQ(frame.accept(1, {0, 0, 16, 16}), Verdict::kForeign);
}

TEST(FrameAssembly, reassigns_only_missing_tiles_and_accepts_them_from_any_node) {
  FrameAssembly frame = planned();
  const auto tiles = balance::tiles_of(kLeft);
  EXPECT_EQ(frame.accept(1, tiles[0]), Verdict::kNew);
  EXPECT_EQ(frame.give_up(1), std::vector{tiles[1]});
  EXPECT_TRUE(frame.give_up(1).empty());
  frame.replan(3, kB, tiles[1]);
  EXPECT_EQ(frame.attempts(tiles[1]), 2);
  EXPECT_EQ(frame.accept(1, tiles[1]), Verdict::kNew);
  EXPECT_EQ(frame.accept(3, tiles[1]), Verdict::kDuplicate);
  EXPECT_EQ(frame.accept(2, kRight), Verdict::kNew);
  EXPECT_TRUE(frame.is_complete());
  EXPECT_TRUE(frame.was_reassigned());
}

/// Cuts a frame of one tile whose node is silent into parts.
std::vector<PixelRect> cut_right(FrameAssembly& frame, std::size_t parts) {
  EXPECT_EQ(frame.give_up(2), std::vector{kRight});
  const std::vector<PixelRect> cut = frame.cut(kRight, parts);
  for (std::size_t i = 0; i < cut.size(); ++i) frame.replan(10 + i, kA, cut[i]);
  return cut;
}

TEST(FrameAssembly, divides_a_tile_into_parts_that_cover_it) {
  for (const std::size_t parts : {1u, 2u, 3u, 4u, 50u}) {
    FrameAssembly frame = planned();
    const auto cut = cut_right(frame, parts);
    EXPECT_EQ(cut.size(), std::min<std::size_t>(parts, 4));
    std::int64_t area = 0;
    for (std::size_t i = 0; i < cut.size(); ++i) {
      area += cut[i].area();
      EXPECT_EQ(cut[i].x % kCutPx, 0);
      EXPECT_EQ(frame.accept(10 + i, cut[i]), Verdict::kNew);
    }
    EXPECT_EQ(area, kRight.area());
    EXPECT_EQ(frame.accept(2, kRight), Verdict::kDuplicate);
  }
}

TEST(FrameAssembly, accepts_a_divided_tile_from_its_first_node_only_before_any_part) {
  FrameAssembly frame = planned();
  const auto cut = cut_right(frame, 2);
  EXPECT_EQ(frame.accept(2, kRight), Verdict::kNew);
  EXPECT_EQ(frame.accept(10, cut[0]), Verdict::kDuplicate);
  EXPECT_EQ(frame.accept(11, cut[1]), Verdict::kDuplicate);

  FrameAssembly other = planned();
  const auto parts = cut_right(other, 2);
  EXPECT_EQ(other.accept(11, parts[1]), Verdict::kNew);
  EXPECT_EQ(other.accept(2, kRight), Verdict::kDuplicate);
  EXPECT_TRUE(other.is_missing_tiles());
  // The part that is still missing is lost as well, and cut once more.
  EXPECT_EQ(other.give_up(10), std::vector{parts[0]});
  const auto again = other.cut(parts[0], 2);
  ASSERT_EQ(again.size(), 2u);
  other.replan(20, kB, again[0]);
  other.replan(21, kB, again[1]);
  EXPECT_EQ(other.accept(20, again[0]), Verdict::kNew);
  EXPECT_EQ(other.accept(10, parts[0]), Verdict::kDuplicate);
  EXPECT_EQ(other.accept(21, again[1]), Verdict::kNew);
}

TEST(FrameAssembly, credits_a_moved_block_to_its_new_node) {
  FrameAssembly frame = planned();
  frame.move(2, 3, kA, 2.0);
  for (const PixelRect& tile : balance::tiles_of(kLeft)) EXPECT_EQ(frame.accept(1, tile), Verdict::kNew);
  frame.end(1, end_of(2.0));
  EXPECT_EQ(frame.accept(3, kRight), Verdict::kNew);
  EXPECT_EQ(frame.accept(2, kRight), Verdict::kDuplicate);
  wire::BlockEnd cancelled = end_of(0.5);
  cancelled.set_error("cancelled");
  frame.end(2, cancelled);
  frame.end(3, end_of(1.0));
  EXPECT_TRUE(frame.is_complete());
  EXPECT_FALSE(frame.was_reassigned());
  const auto sum = frame.summary();
  ASSERT_EQ(sum.costs.size(), 2u);
  EXPECT_EQ(sum.costs[1].rect, kRight);
  EXPECT_DOUBLE_EQ(sum.costs[1].cpu_seconds, 1.0);
  EXPECT_DOUBLE_EQ(sum.costs[1].speed, 2.0);
}

TEST(FrameAssembly, accepts_costs_only_of_the_blocks_own_cells) {
  FrameAssembly frame = planned();
  wire::BlockEnd end = end_of(1.0);
  for (int i = 0; i < 256; ++i) end.add_cell_cpu_seconds(i == 7 ? -1.0f : 0.5f);
  frame.end(2, end);
  EXPECT_EQ(frame.summary().costs.at(0).cell_cpu_seconds.size(), 256u);
  EXPECT_EQ(frame.summary().costs.at(0).cell_cpu_seconds[7], 0.0f);
  end.add_cell_cpu_seconds(1.0f);
  frame.end(2, end);
  EXPECT_TRUE(frame.summary().costs.at(0).cell_cpu_seconds.empty());
}

TEST(FrameAssembly, ignores_invalid_times) {
  FrameAssembly frame = planned();
  frame.end(1, end_of(std::numeric_limits<double>::quiet_NaN()));
  frame.end(2, end_of(-std::numeric_limits<double>::infinity()));
  const auto sum = frame.summary();
  EXPECT_EQ(sum.cpu_seconds, 0.0);
  EXPECT_EQ(sum.render_seconds, 0.0);
}

TEST(FrameAssembly, waits_for_the_nodes_that_owe_a_block_whatever_becomes_of_their_blocks) {
  FrameAssembly frame;
  const NodeId first{1};
  const NodeId second{2};
  frame.plan(1, first, {0, 0, 256, 256});
  frame.plan(2, first, {256, 0, 256, 256});
  frame.plan(3, first, {512, 0, 256, 256});
  EXPECT_TRUE(frame.waits_for(first));
  EXPECT_FALSE(frame.waits_for(second));
  frame.move(3, 4, second, 1.0);
  EXPECT_TRUE(frame.waits_for(second));
  frame.end(1, {});
  frame.give_up(1);
  EXPECT_TRUE(frame.waits_for(first));
  frame.give_up(2);
  EXPECT_FALSE(frame.waits_for(first));
  frame.end(2, {});
  frame.end(3, {});
  EXPECT_FALSE(frame.waits_for(first));
  frame.end(4, {});
  EXPECT_FALSE(frame.waits_for(second));
}

}  // namespace
}  // namespace cyclorama::coordinator
