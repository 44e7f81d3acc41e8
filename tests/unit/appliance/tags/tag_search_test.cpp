// SPDX-License-Identifier: Apache-2.0
#include "appliance/tags/tag_search.h"

#include <gtest/gtest.h>

#include <set>

#include "common/wand/folded_card.h"
#include "drivers/simulated/camera/tag_painter.h"

namespace cyclorama::tags {
namespace {

const Pinhole kLens{640, 480, 600.0, 320.0, 240.0};
using Pose = RigidTransform<frame::Camera, frame::Tag>;

Pose pose_at(double x, double y, double z) { return {Eigen::Quaterniond::Identity(), {x, y, z}}; }

GreyImage paint(const std::vector<std::pair<Wand, Pose>>& wands) {
  Image<float, 1> light(kLens.width_px, kLens.height_px, 100.0f);
  for (const auto& [wand, pose] : wands) simulated::TagPainter(wand).paint({pose}, kLens, &light);
  GreyImage grey(kLens.width_px, kLens.height_px);
  for (std::size_t i = 0; i < grey.data().size(); ++i) grey.data()[i] = static_cast<std::uint8_t>(light.data()[i]);
  return grey;
}

TagSearch search_of(const DetectorSettings& settings = {}) {
  auto search = TagSearch::create(settings);
  EXPECT_TRUE(search.has_value());
  return *std::move(search);
}

std::multiset<int> ids_in(const GreyImage& picture, TagSearch* search) {
  const auto found = search->search(picture);
  EXPECT_TRUE(found.has_value());
  std::multiset<int> ids;
  for (const TagDetection& tag : *found) ids.insert(tag.id);
  return ids;
}

TEST(TagSearch, finds_a_near_wand_in_its_first_picture) {
  TagSearch search = search_of();
  EXPECT_EQ(ids_in(paint({{standard_wand(2), pose_at(0, 0, 1)}}), &search), (std::multiset<int>{6, 7, 8}));
}

TEST(TagSearch, finds_tags_that_decimation_hides_within_a_round_and_keeps_them) {
  std::vector<std::pair<Wand, Pose>> tags;
  std::multiset<int> all;
  for (int i = 0; i < 12; ++i) {
    // 13 pixels across: too small for a search of half the picture's size, everywhere in the picture.
    tags.emplace_back(flat_tag(i, 0.05), pose_at(-0.75 + 0.5 * (i % 4), -0.5 + 0.5 * (i / 4), 2.3));
    all.insert(i);
  }
  const GreyImage picture = paint(tags);
  DetectorSettings halved;
  halved.decimate = 2.0;
  DetectorSettings whole = halved;
  whole.tiles = false;
  TagSearch decimated = search_of(whole);
  EXPECT_LT(ids_in(picture, &decimated).size(), all.size());
  TagSearch search = search_of(halved);
  for (int i = 0; i < TagSearch::kJobs; ++i) ids_in(picture, &search);
  for (int i = 0; i < TagSearch::kJobs; ++i) EXPECT_EQ(ids_in(picture, &search), all) << i;
}

TEST(TagSearch, follows_a_hand_that_moves_fast) {
  TagSearch search = search_of();
  for (int i = 0; i < 30; ++i) {
    // 3 m/s at 30 pictures per second.
    const double x = 0.35 - 0.1 * (i < 8 ? i : 15 - std::min(i, 15));
    EXPECT_EQ(ids_in(paint({{standard_wand(0), pose_at(x, 0.05, 1.0)}}), &search).size(), 3U) << i;
  }
}

TEST(TagSearch, finds_a_wand_again_wherever_it_reappears) {
  TagSearch search = search_of();
  ids_in(paint({{standard_wand(0), pose_at(0.3, 0.1, 1.0)}}), &search);
  EXPECT_TRUE(ids_in(paint({}), &search).empty());
  EXPECT_EQ(ids_in(paint({{standard_wand(0), pose_at(-0.3, -0.1, 0.9)}}), &search).size(), 3U);
}

TEST(TagSearch, returns_each_tag_once_and_two_cards_with_one_number_twice) {
  TagSearch search = search_of();
  const GreyImage picture =
      paint({{standard_wand(0), pose_at(-0.25, 0.0, 1.0)}, {standard_wand(0), pose_at(0.25, 0.0, 1.0)}});
  for (int i = 0; i < TagSearch::kJobs; ++i) {
    EXPECT_EQ(ids_in(picture, &search), (std::multiset<int>{0, 0, 1, 1, 2, 2})) << i;
  }
}

TEST(TagSearch, survives_pictures_of_any_size_in_any_order) {
  TagSearch search = search_of();
  const GreyImage with_tag = paint({{standard_wand(0), pose_at(0, 0, 0.7)}});
  for (const auto& [width, height] :
       {std::pair{0, 0}, {1, 1}, {7, 500}, {16, 16}, {640, 480}, {31, 33}, {1000, 9}, {9, 1000}}) {
    for (int i = 0; i < 2 * TagSearch::kJobs; ++i) ids_in(GreyImage(width, height, 128), &search);
    EXPECT_EQ(ids_in(with_tag, &search).size(), 3U);
  }
}

}  // namespace
}  // namespace cyclorama::tags
