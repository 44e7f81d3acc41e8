// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/tag_tracking.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <random>

#include "appliance/tracker/tag_pose.h"
#include "common/wand/folded_card.h"

namespace cyclorama::tracker {
namespace {

using std::chrono::milliseconds;

const Pinhole kLens = Pinhole::from_field_of_view(640, 480, 1.0472);
const TimePoint kStart(std::chrono::seconds(1000));

tags::TagDetection tag(int id, double x_m, double z_m) {
  tags::TagDetection detection{id, 0, 80.0, {}};
  for (std::size_t i = 0; i < 4; ++i) {
    detection.corners[i] = *kLens.pixel_of(corners_of_tag(0.12)[i] + Eigen::Vector3d(x_m, 0.0, z_m));
  }
  return detection;
}

/// Settings for flat tags of 0.12 m.
TrackingSettings flat() {
  TrackingSettings settings;
  settings.patterns.flat_tag_size_m = 0.12;
  return settings;
}

std::optional<int> id_of(const TrackingResult& result) {
  return result.tag ? std::optional<int>(result.tag->wand.id()) : std::nullopt;
}

TEST(TagTracking, returns_the_pose_of_the_tag_in_the_picture) {
  const std::vector<tags::TagDetection> seen{tag(4, 0.2, 0.9)};
  const auto result = track(flat(), {}, seen, kLens, kStart);
  ASSERT_TRUE(result.tag.has_value());
  EXPECT_LT((result.tag->T_camera_tag.translation() - Eigen::Vector3d(0.2, 0.0, 0.9)).norm(), 1e-4);
  EXPECT_LT(result.tag->chosen.pose.reprojection_px, 1e-3);
}

TEST(TagTracking, keeps_its_tag_when_a_larger_one_appears) {
  const std::vector<tags::TagDetection> first{tag(4, 0.2, 0.9)};
  const std::vector<tags::TagDetection> both{tag(9, -0.2, 0.5), tag(4, 0.2, 0.9)};
  const auto before = track(flat(), {}, first, kLens, kStart);
  EXPECT_EQ(id_of(track(flat(), before.state, both, kLens, kStart + milliseconds(33))), 4);
  EXPECT_EQ(id_of(track(flat(), {}, both, kLens, kStart)), 9);
}

TEST(TagTracking, changes_to_another_tag_only_after_its_own_was_lost_for_a_while) {
  const std::vector<tags::TagDetection> own{tag(4, 0.2, 0.9)};
  const std::vector<tags::TagDetection> other{tag(9, -0.2, 0.5)};
  const auto before = track(flat(), {}, own, kLens, kStart);
  const auto soon = track(flat(), before.state, other, kLens, kStart + milliseconds(100));
  EXPECT_EQ(id_of(soon), std::nullopt);
  const auto later = track(flat(), soon.state, other, kLens, kStart + milliseconds(300));
  ASSERT_EQ(id_of(later), 9);
  // The filter is reset: nothing of the first tag's position is left.
  EXPECT_LT((later.tag->T_camera_tag.translation() - Eigen::Vector3d(-0.2, 0.0, 0.5)).norm(), 1e-4);
}

TEST(TagTracking, follows_only_the_configured_tag) {
  TrackingSettings settings = flat();
  settings.patterns.only = 4;
  const std::vector<tags::TagDetection> other{tag(9, -0.2, 0.5)};
  const std::vector<tags::TagDetection> both{tag(9, -0.2, 0.5), tag(4, 0.2, 0.9)};
  EXPECT_EQ(id_of(track(settings, {}, other, kLens, kStart)), std::nullopt);
  EXPECT_EQ(id_of(track(settings, {}, both, kLens, kStart)), 4);
}

TEST(TagTracking, keeps_its_state_when_the_corners_are_impossible) {
  tags::TagDetection broken = tag(4, 0.2, 0.9);
  broken.corners[1].x() = std::numeric_limits<double>::quiet_NaN();
  const std::vector<tags::TagDetection> first{tag(4, 0.2, 0.9)};
  const std::vector<tags::TagDetection> bad{broken};
  const auto before = track(flat(), {}, first, kLens, kStart);
  const auto result = track(flat(), before.state, bad, kLens, kStart + milliseconds(33));
  EXPECT_FALSE(result.tag.has_value());
  EXPECT_EQ(result.state.seen_at, kStart);
}

TEST(TagTracking, returns_the_same_pose_for_a_repeated_time) {
  const std::vector<tags::TagDetection> first{tag(4, 0.2, 0.9)};
  const std::vector<tags::TagDetection> moved{tag(4, 0.0, 0.9)};
  const auto before = track(flat(), {}, first, kLens, kStart);
  const auto again = track(flat(), before.state, moved, kLens, kStart);
  ASSERT_TRUE(again.tag.has_value());
  EXPECT_EQ(again.tag->T_camera_tag.translation(), before.tag->T_camera_tag.translation());
}

std::vector<tags::TagDetection> wand_at(int number, const Eigen::Vector3d& position) {
  std::vector<tags::TagDetection> seen;
  for (const WandTag& tag : standard_wand(number).tags) {
    tags::TagDetection detection{tag.id, 0, 80.0, {}};
    for (std::size_t i = 0; i < 4; ++i) detection.corners[i] = *kLens.pixel_of(tag.corners[i] + position);
    seen.push_back(detection);
  }
  return seen;
}

TEST(TagTracking, follows_a_standard_wand_by_all_its_tags_and_states_its_uncertainty) {
  auto seen = wand_at(3, {0.1, 0.0, 1.1});
  const auto result = track({}, {}, seen, kLens, kStart);
  ASSERT_EQ(id_of(result), 9);
  EXPECT_EQ(result.tag->seen.size(), 3U);
  EXPECT_LT((result.tag->T_camera_tag.translation() - Eigen::Vector3d(0.1, 0.0, 1.1)).norm(), 1e-4);
  EXPECT_GT(result.tag->covariance(1, 1), 0.0);
  // The wand's name does not depend on which of its tags are visible.
  seen.erase(seen.begin());
  EXPECT_EQ(id_of(track({}, result.state, seen, kLens, kStart + milliseconds(33))), 9);
}

TEST(TagTracking, keeps_its_wand_when_a_nearer_one_appears) {
  const auto first = wand_at(3, {0.2, 0.0, 1.1});
  auto both = wand_at(4, {-0.2, 0.0, 0.8});
  both.insert(both.end(), first.begin(), first.end());
  const auto before = track({}, {}, first, kLens, kStart);
  EXPECT_EQ(id_of(track({}, before.state, both, kLens, kStart + milliseconds(33))), 9);
  EXPECT_EQ(id_of(track({}, {}, both, kLens, kStart)), 12);
}

TEST(TagTracking, does_not_mix_two_cards_with_the_same_number) {
  auto both = wand_at(3, {0.35, 0.0, 1.1});
  const auto other = wand_at(3, {-0.35, 0.0, 1.2});
  both.insert(both.end(), other.begin(), other.end());
  const auto result = track({}, {}, both, kLens, kStart);
  ASSERT_EQ(id_of(result), 9);
  EXPECT_LT((result.tag->T_camera_tag.translation() - Eigen::Vector3d(0.35, 0.0, 1.1)).norm(), 1e-4);
}

/// Returns the middle tag of a wand alone, small and turned by `yaw_deg`, its corners off by at most a quarter of a
/// pixel.
std::vector<tags::TagDetection> lone_tag_at(double yaw_deg, unsigned picture) {
  std::mt19937 random(picture);
  std::uniform_real_distribution<double> off(-0.25, 0.25);
  const WandTag tag = standard_wand(0).tags[1];
  tags::TagDetection detection{tag.id, 0, 80.0, {}};
  const Eigen::AngleAxisd turned(yaw_deg * std::numbers::pi / 180.0, Eigen::Vector3d::UnitY());
  for (std::size_t i = 0; i < 4; ++i) {
    detection.corners[i] = *kLens.pixel_of(turned * tag.corners[i] + Eigen::Vector3d(0.0, 0.0, 2.5)) +
                           Eigen::Vector2d(off(random), off(random));
    detection.covariance[i] = 0.02 * Eigen::Matrix2d::Identity();
  }
  return {detection};
}

TEST(TagTracking, waits_while_the_pose_of_a_small_tag_is_ambiguous) {
  int told = 0, wrong = 0, waited = 0;
  for (unsigned hand = 0; hand < 300; ++hand) {
    const double yaw_deg = hand % 2 == 0 ? 45.0 : -45.0;
    TrackingState state;
    for (unsigned i = 0; i < 10; ++i) {
      const auto seen = lone_tag_at(yaw_deg, 100 * hand + i);
      const TrackingResult result = track({}, state, seen, kLens, kStart + milliseconds(33) * i);
      state = result.state;
      EXPECT_EQ(state.id, 0) << "followed, all the same";
      if (!result.tag) {
        ++waited;
        continue;
      }
      ++told;
      const Eigen::Vector3d into = result.tag->chosen.pose.T_camera_tag.rotation() * Eigen::Vector3d::UnitZ();
      wrong += into.x() * yaw_deg < 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(waited, 100) << "one picture of such a tag says too little";
  EXPECT_GT(told, 300) << "but time tells";
  EXPECT_LE(wrong, told / 100);
}

TEST(TagTracking, accepts_measured_wands_only) {
  TrackingSettings settings;
  settings.patterns.wands = {flat_tag(500, 0.2)};
  EXPECT_EQ(id_of(track(settings, {}, wand_at(3, {0.1, 0.0, 1.1}), kLens, kStart)), std::nullopt);
  EXPECT_EQ(settings.patterns.pattern_of(500)->tags[0].size_m, 0.2);
  EXPECT_FALSE(TrackingSettings().patterns.pattern_of(586).has_value()) << "the 587 tags leave two over";
  EXPECT_TRUE(TrackingSettings().patterns.pattern_of(584).has_value());
}

}  // namespace
}  // namespace cyclorama::tracker
