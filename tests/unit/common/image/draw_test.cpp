// SPDX-License-Identifier: Apache-2.0
#include "common/image/draw.h"

#include <gtest/gtest.h>

#include <limits>

namespace cyclorama {
namespace {

constexpr Colour kInk{200, 100, 50};

int inked(const RgbImage& picture) {
  int count = 0;
  for (std::size_t i = 0; i < picture.data().size(); i += 3) count += picture.data()[i] == kInk[0] ? 1 : 0;
  return count;
}
bool is_inked(const RgbImage& picture, int x, int y) { return *picture.at(x, y) == kInk[0]; }

TEST(DrawLine, includes_both_ends) {
  RgbImage picture(20, 10);
  draw_line(&picture, {2.5, 1.5}, {15.5, 7.5}, kInk);
  EXPECT_TRUE(is_inked(picture, 2, 1));
  EXPECT_TRUE(is_inked(picture, 15, 7));
  EXPECT_FALSE(is_inked(picture, 1, 1));
  EXPECT_FALSE(is_inked(picture, 17, 8));
  for (int x = 2; x <= 15; ++x) {
    int column = 0;
    for (int y = 0; y < 10; ++y) column += is_inked(picture, x, y) ? 1 : 0;
    EXPECT_GE(column, 1) << "a gap at " << x;
  }
}

TEST(DrawLine, has_the_requested_width) {
  RgbImage picture(20, 20);
  draw_line(&picture, {-100, 10}, {100, 10}, kInk, 4);
  EXPECT_EQ(inked(picture), 20 * 4);
}

TEST(DrawLine, draws_the_visible_part_of_a_line_from_far_away) {
  RgbImage picture(20, 20);
  draw_line(&picture, {-1e15, 10.5}, {1e15, 10.5}, kInk);
  EXPECT_EQ(inked(picture), 20);
}

TEST(DrawLine, ignores_lines_that_are_outside_or_not_finite) {
  RgbImage picture(20, 20);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  draw_line(&picture, {nan, 1}, {5, 5}, kInk);
  draw_line(&picture, {1, 1}, {inf, 5}, kInk);
  draw_line(&picture, {-50, -50}, {-5, 70}, kInk);
  draw_line(&picture, {1e308, 5}, {-1e308, 5}, kInk);
  EXPECT_EQ(inked(picture), 0);
  RgbImage nothing;
  draw_line(&nothing, {0, 0}, {5, 5}, kInk);
  draw_text(&nothing, 0, 0, "text", kInk);
}

TEST(DrawText, draws_letters_of_five_by_seven_pixels) {
  RgbImage picture(40, 10);
  draw_text(&picture, 1, 1, "I1", kInk);
  EXPECT_TRUE(is_inked(picture, 3, 4));  // The stem of the I.
  EXPECT_FALSE(is_inked(picture, 1, 4));
  RgbImage small(40, 10);
  draw_text(&small, 1, 1, "i1", kInk);
  EXPECT_EQ(picture, small);
}

TEST(DrawText, clips_at_the_pictures_edges) {
  RgbImage picture(9, 9);
  draw_text(&picture, -3, -3, "WWWWWWWW", kInk, 3);
  draw_text(&picture, 100, 100, "W", kInk);
  draw_text(&picture, 0, 0, "\xff\x01", kInk);
  EXPECT_GT(inked(picture), 0);
}

TEST(ToRgb, repeats_the_grey_value) {
  GreyImage grey(2, 1);
  *grey.at(1, 0) = 77;
  const RgbImage rgb = to_rgb(grey);
  EXPECT_EQ(rgb.at(1, 0)[0], 77);
  EXPECT_EQ(rgb.at(1, 0)[2], 77);
  EXPECT_EQ(rgb.at(0, 0)[1], 0);
}

}  // namespace
}  // namespace cyclorama
