// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/head/frame_assembly.h"

#include <gtest/gtest.h>

#include <limits>

#include "renderfarm/balance/tiles.h"

namespace cyclorama {
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

TEST(FrameAssembly, is_complete_when_all_tiles_and_ends_came) {
  FrameAssembly frame = planned();
  for (const PixelRect& tile : tiles_of(kLeft)) EXPECT_EQ(frame.accept(1, tile), Verdict::kNew);
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

TEST(FrameAssembly, tells_new_from_duplicate_from_foreign) {
  FrameAssembly frame = planned();
  const PixelRect tile = tiles_of(kLeft).front();
  EXPECT_EQ(frame.accept(1, tile), Verdict::kNew);
  EXPECT_EQ(frame.accept(1, tile), Verdict::kDuplicate);
  EXPECT_EQ(frame.accept(2, tile), Verdict::kForeign);
  EXPECT_EQ(frame.accept(9, tile), Verdict::kForeign);
  EXPECT_EQ(frame.accept(1, {0, 0, 16, 16}), Verdict::kForeign);
}

TEST(FrameAssembly, gives_up_only_what_is_missing_and_takes_it_from_whoever_is_first) {
  FrameAssembly frame = planned();
  const auto tiles = tiles_of(kLeft);
  EXPECT_EQ(frame.accept(1, tiles[0]), Verdict::kNew);
  EXPECT_EQ(frame.give_up(1), std::vector{tiles[1]});
  EXPECT_TRUE(frame.give_up(1).empty());
  frame.plan_again(3, kB, tiles[1]);
  EXPECT_EQ(frame.attempts(tiles[1]), 2);
  EXPECT_EQ(frame.accept(1, tiles[1]), Verdict::kNew);
  EXPECT_EQ(frame.accept(3, tiles[1]), Verdict::kDuplicate);
  EXPECT_EQ(frame.accept(2, kRight), Verdict::kNew);
  EXPECT_TRUE(frame.is_complete());
  EXPECT_TRUE(frame.was_given_again());
}

TEST(FrameAssembly, does_not_believe_times_that_are_none) {
  FrameAssembly frame = planned();
  frame.end(1, end_of(std::numeric_limits<double>::quiet_NaN()));
  frame.end(2, end_of(-std::numeric_limits<double>::infinity()));
  const auto sum = frame.summary();
  EXPECT_EQ(sum.cpu_seconds, 0.0);
  EXPECT_EQ(sum.render_seconds, 0.0);
}

}  // namespace
}  // namespace cyclorama
