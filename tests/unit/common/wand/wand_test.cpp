// SPDX-License-Identifier: Apache-2.0
#include "common/wand/wand.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "common/wand/folded_card.h"
#include "common/wand/tag_bitmap.h"

namespace cyclorama {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

std::string mistake_in(const std::string& text) {
  const auto wand = parse_wand(text, "wand.toml");
  EXPECT_FALSE(wand.has_value()) << text;
  return wand ? "" : wand.error().message();
}

std::string tag_text(int id, const std::string& corners) {
  return "[[tag]]\nid = " + std::to_string(id) + "\nsize_mm = 70\ncorners_mm = " + corners + "\n";
}
const std::string kSquare = "[[-35, -35, 0], [35, -35, 0], [35, 35, 0], [-35, 35, 0]]";

TEST(StandardWand, has_three_tags_of_which_the_outer_ones_are_folded_back) {
  const Wand wand = standard_wand(5);
  ASSERT_EQ(wand.tags.size(), 3U);
  const FoldedCard card;
  Vector3d middle = Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const WandTag& tag = wand.tags[static_cast<std::size_t>(i)];
    EXPECT_EQ(tag.id, 15 + i);
    const auto face = face_of(tag);
    const Vector3d into = face.rotation() * Vector3d::UnitZ();
    // The left panel faces left, as seen from the front, so its inward normal points right.
    EXPECT_LT((into - Vector3d(std::sin((1 - i) * card.fold_rad), 0, std::cos((1 - i) * card.fold_rad))).norm(), 1e-12);
    EXPECT_EQ((face.rotation() * Vector3d::UnitY()).y(), 1.0);
    middle += face.translation() / 3.0;
  }
  EXPECT_LT(middle.norm(), 1e-12);
}

TEST(StandardWand, is_a_folded_flat_sheet) {
  const FoldedCard card = FoldedCard().scaled(1.3);
  const Wand wand = standard_wand(0, card);
  // Facing edges of neighbouring tags have the same distance from the fold as on the sheet.
  const double margin = 0.5 * (card.panel_width_m - card.tag_size_m);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& left = wand.tags[i];
    const auto& right = wand.tags[i + 1];
    const Vector3d from_left = left.corners[1] + margin * (left.corners[1] - left.corners[0]).normalized();
    const Vector3d from_right = right.corners[0] + margin * (right.corners[0] - right.corners[1]).normalized();
    EXPECT_LT((from_left - from_right).norm(), 1e-12);
  }
}

TEST(Wand, survives_a_round_trip) {
  Wand wand = standard_wand(7);
  wand.name = "the \"old\" one \\ blue";
  const auto again = parse_wand(wand_toml(wand), "wand.toml");
  ASSERT_TRUE(again.has_value()) << again.error().message();
  EXPECT_EQ(again->name, wand.name);
  ASSERT_EQ(again->tags.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(again->tags[i].id, wand.tags[i].id);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_LT((again->tags[i].corners[k] - wand.tags[i].corners[k]).norm(), 1e-6);
  }
}

TEST(Wand, names_the_line_of_a_mistake) {
  EXPECT_THAT(mistake_in(""), HasSubstr("needs [[tag]] tables"));
  EXPECT_THAT(mistake_in(tag_text(1, kSquare) + tag_text(1, kSquare)), HasSubstr("wand.toml:6: "));
  EXPECT_THAT(mistake_in(tag_text(1, "[[0, 0, 0]]")), HasSubstr("must be four points"));
  EXPECT_THAT(mistake_in(tag_text(-1, kSquare)), HasSubstr("wand.toml:2:"));
  EXPECT_THAT(mistake_in(tag_text(1, kSquare) + "colour = 1\n"), HasSubstr("wand.toml:5:"));
  // Two corners swapped, another size, and one corner displaced.
  EXPECT_THAT(mistake_in(tag_text(1, "[[35, -35, 0], [-35, -35, 0], [35, 35, 0], [-35, 35, 0]]")),
              HasSubstr("measure again"));
  EXPECT_THAT(mistake_in(tag_text(1, "[[-30, -30, 0], [30, -30, 0], [30, 30, 0], [-30, 30, 0]]")),
              HasSubstr("measure again"));
  EXPECT_THAT(mistake_in(tag_text(1, "[[-35, -35, 0], [35, -35, 0], [35, 35, 40], [-35, 35, 0]]")),
              HasSubstr("measure again"));
  EXPECT_THAT(mistake_in(tag_text(1, "[[nan, -35, 0], [35, -35, 0], [35, 35, 0], [-35, 35, 0]]")),
              HasSubstr("wand.toml:4:"));
  std::string many;
  for (int i = 0; i < 33; ++i) many += tag_text(i, kSquare);
  EXPECT_THAT(mistake_in(many), HasSubstr("at most 32 tags"));
}

TEST(Wand, accepts_corners_measured_with_a_ruler) {
  EXPECT_TRUE(
      parse_wand(tag_text(1, "[[-35.5, -35, 0], [35, -34.6, 1], [35, 35, 0], [-34.8, 35, 0]]"), "w").has_value());
}

TEST(TagBitmap, has_a_white_border_around_a_black_one) {
  const TagBitmap bitmap = tag_bitmap(kBitmaps - 1);
  ASSERT_EQ(bitmap.cells, 10);
  EXPECT_EQ(bitmap.width_in_tags, 1.25);
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(bitmap.is_white(i, 0) && bitmap.is_white(0, i) && bitmap.is_white(9, i) && bitmap.is_white(i, 9));
  }
  for (int i = 1; i < 9; ++i) {
    EXPECT_FALSE(bitmap.is_white(i, 1) || bitmap.is_white(1, i) || bitmap.is_white(8, i) || bitmap.is_white(i, 8));
  }
}

}  // namespace
}  // namespace cyclorama
