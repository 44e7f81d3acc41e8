// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "appliance/healing/estimator/areas.h"
#include "appliance/healing/estimator/exposure_timing.h"
#include "appliance/healing/estimator/patch_alignment.h"
#include "appliance/healing/estimator/show_timeline.h"

namespace cyclorama::healing {
namespace {

using namespace std::chrono_literals;

/// A sum of waves, whose values between pixels are known.
float waves(double x, double y) {
  return static_cast<float>(0.5 + 0.12 * std::sin(0.31 * x + 0.13 * y) + 0.1 * std::sin(0.17 * y - 0.05 * x) +
                            0.08 * std::sin(0.23 * x - 0.29 * y + 1.0) + 0.05 * std::sin(0.001 * x * y));
}

Prediction waving(int width, int height) {
  Prediction made{{1, Image<float, 1>(width, height)}, Image<std::int8_t, 1>(width, height, 0)};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) *made.light.light.at(x, y) = waves(x, y);
  }
  return made;
}

TEST(AlignPatches, finds_a_shift_to_a_twentieth_of_a_pixel_for_any_gain_and_offset) {
  const Prediction prediction = waving(200, 160);
  const Eigen::Vector2d shift(1.37, -0.81);
  LightPlane picture{1, Image<float, 1>(200, 160)};
  std::mt19937 random(1);
  std::normal_distribution<float> noise(0.0f, 0.0005f);
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 200; ++x)
      *picture.light.at(x, y) = 0.3f * waves(x - shift.x(), y - shift.y()) + 0.2f + noise(random);
  }
  int found = 0;
  for (const PatchShift& patch : align_patches(prediction, picture, 0.3)) {
    if (patch.fit != PatchFit::kFits) continue;
    ++found;
    EXPECT_LT((patch.shift - shift).norm(), 0.05);
    EXPECT_NEAR(patch.contrast, 1.0, 0.1);
    EXPECT_GT(patch.covariance.determinant(), 0.0);
  }
  EXPECT_GT(found, 50);
}

TEST(AlignPatches, distinguishes_flat_shared_and_missing_patches) {
  Prediction prediction = waving(200, 160);
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 60; ++x) *prediction.light.light.at(x, y) = 0.4f;
    for (int x = 140; x < 200; ++x) *prediction.owner.at(x, y) = kOverlap;
  }
  LightPlane picture{1, Image<float, 1>(200, 160, 0.5f)};
  std::mt19937 random(2);
  std::uniform_real_distribution<float> anything(0.0f, 1.0f);
  for (float& v : picture.light.data()) v = anything(random);
  for (const PatchShift& patch : align_patches(prediction, picture, 1.0)) {
    if (patch.at.x() < 45) {
      EXPECT_EQ(patch.fit, PatchFit::kPlain);
    } else if (patch.at.x() > 152) {
      EXPECT_EQ(patch.fit, PatchFit::kShared);
    } else if (patch.at.x() > 72 && patch.at.x() < 128 && patch.at.y() > 30 && patch.at.y() < 130) {
      // Nearer to the rim the search may leave the picture, which gives no result.
      EXPECT_EQ(patch.fit, PatchFit::kDiffers);
    }
  }
}

TEST(AlignCoarsely, is_not_misled_by_stripes) {
  Prediction stripes = waving(400, 320);
  for (int y = 0; y < 320; ++y) {
    for (int x = 0; x < 400; ++x)
      *stripes.light.light.at(x, y) = static_cast<float>(0.5 + 0.4 * std::sin(0.35 * x) * std::sin(0.35 * y));
  }
  const auto patches = align_coarsely(stripes, stripes.light, 1.0);
  EXPECT_EQ(std::ranges::count(patches, PatchFit::kFits, &PatchShift::fit), 0);
  const Prediction unlike = waving(400, 320);
  const auto others = align_coarsely(unlike, unlike.light, 1.0);
  EXPECT_GT(std::ranges::count(others, PatchFit::kFits, &PatchShift::fit), 10);
}

TEST(LightScale, is_linear_between_dark_and_bright) {
  const Prediction prediction = waving(320, 320);
  LightPlane picture = prediction.light;
  for (float& v : picture.light.data()) v = 0.25f * v + 0.1f;
  const LightScale scale = light_scale(prediction, picture);
  EXPECT_NEAR(scale.gain, 0.25, 1e-4);
  EXPECT_NEAR(scale.offset, 0.1, 1e-4);
}

TEST(LightPlane, is_sampled_linearly_inside_and_dark_outside) {
  LightPlane plane{1, Image<float, 1>(8, 6)};
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 8; ++x) *plane.light.at(x, y) = static_cast<float>(1 + x + 10 * y);
  }
  EXPECT_FLOAT_EQ(plane.at(3.25f, 2.5f), 1.0f + 2.75f + 20.0f);
  EXPECT_FLOAT_EQ(plane.at(0.5f, 0.5f), 1.0f);
  EXPECT_FLOAT_EQ(plane.at(-1.0f, 3.0f), 0.0f);
  EXPECT_FLOAT_EQ(plane.at(std::nanf(""), 3.0f), 0.0f);
  EXPECT_FLOAT_EQ(plane.at(0.0f, 0.5f), 0.5f);
}

TEST(Areas, distrust_an_occluded_area_until_it_has_fitted_again_for_a_while) {
  std::vector<PatchShift> patches(10);
  for (PatchShift& patch : patches) {
    patch.projector = 0;
    patch.fit = PatchFit::kFits;
  }
  AreaMap map;
  map.update(patches);
  patches[3].fit = PatchFit::kDiffers;
  for (int i = 0; i < 3; ++i) map.update(patches);
  EXPECT_EQ(map.area(3), Area::kInTheWay);
  EXPECT_EQ(map.area(4), Area::kProjector);
  EXPECT_NEAR(map.hidden(), 0.1, 1e-9);
  patches[3].fit = PatchFit::kFits;
  map.update(patches);
  EXPECT_FALSE(map.is_trusted(3));
  for (int i = 0; i < 5; ++i) map.update(patches);
  EXPECT_TRUE(map.is_trusted(3));
}

calibration::ShowProjector small_projector() {
  calibration::ShowProjector projector;
  projector.lens = {8, 4, 10.0, 10.0, 4.0, 2.0};
  projector.light.fill(calibration::gamma_light(1.0));
  projector.grey = {1.0f, 0.0f, 0.0f};
  return projector;
}

ShownPicture shown_at(Duration at, std::uint8_t code, std::uint64_t number = 1) {
  return {0, TimePoint{} + at, std::make_shared<const RgbImage>(8, 4, code), number};
}

TEST(ShowTimeline, weights_pictures_by_their_time_within_an_exposure) {
  ShowTimeline timeline(small_projector(), 2);
  // Reports arrive late, out of order and repeatedly.
  timeline.add(shown_at(300ms, 51, 2));
  timeline.add(shown_at(100ms, 255, 1));
  timeline.add(shown_at(100ms, 255, 1));
  timeline.known_until({0, TimePoint{} + 400ms, 2});
  const auto mixed = timeline.between(TimePoint{} + 250ms, TimePoint{} + 350ms);
  ASSERT_TRUE(mixed);
  EXPECT_NEAR(static_cast<double>(*mixed->light.light.at(1, 1)), 0.6, 1e-6);
  const auto before = timeline.between(TimePoint{} + 150ms, TimePoint{} + 200ms);
  ASSERT_TRUE(before);
  EXPECT_FLOAT_EQ(*before->light.light.at(1, 1), 1.0f);
}

TEST(ShowTimeline, reports_that_it_does_not_know_yet) {
  ShowTimeline timeline(small_projector(), 2);
  EXPECT_FALSE(timeline.between(TimePoint{}, TimePoint{} + 10ms));
  timeline.add(shown_at(100ms, 255, 1));
  EXPECT_FALSE(timeline.between(TimePoint{} + 110ms, TimePoint{} + 150ms)) << "something else may have come since";
  timeline.known_until({0, TimePoint{} + 250ms, 1});
  EXPECT_TRUE(timeline.between(TimePoint{} + 110ms, TimePoint{} + 150ms));
  EXPECT_FALSE(timeline.between(TimePoint{} + 50ms, TimePoint{} + 150ms));
  EXPECT_FALSE(timeline.between(TimePoint{} + 150ms, TimePoint{} + 150ms));
  EXPECT_FALSE(timeline.between(TimePoint{} + 150ms, TimePoint{} + 300ms)) << "later than is known";
  timeline.add({0, TimePoint{} + 200ms, nullptr, 2});
  timeline.known_until({0, TimePoint{} + 250ms, 2});
  const auto dark = timeline.between(TimePoint{} + 210ms, TimePoint{} + 220ms);
  ASSERT_TRUE(dark);
  EXPECT_TRUE(dark->light.light.empty());
}

TEST(ShowTimeline, forgets_old_pictures_but_not_the_one_that_is_shown) {
  ShowTimeline timeline(small_projector(), 2);
  for (int i = 0; i < 100; ++i) timeline.add(shown_at(i * 100ms, 10, static_cast<std::uint64_t>(i + 1)));
  timeline.known_until({0, TimePoint{} + 30s, 100});
  EXPECT_FALSE(timeline.between(TimePoint{} + 1s, TimePoint{} + 1010ms));
  EXPECT_TRUE(timeline.between(TimePoint{} + 20s, TimePoint{} + 20010ms));
}

TEST(ShowTimeline, does_not_guess_when_an_unreported_picture_appeared) {
  ShowTimeline timeline(small_projector(), 2);
  timeline.add(shown_at(100ms, 255, 1));
  timeline.add(shown_at(200ms, 51, 2));
  timeline.known_until({0, TimePoint{} + 250ms, 3});
  EXPECT_FALSE(timeline.between(TimePoint{} + 210ms, TimePoint{} + 240ms)) << "the third came some time by then";
  EXPECT_TRUE(timeline.between(TimePoint{} + 110ms, TimePoint{} + 190ms));
  timeline.add(shown_at(300ms, 99, 4));
  timeline.known_until({0, TimePoint{} + 350ms, 4});
  EXPECT_FALSE(timeline.between(TimePoint{} + 210ms, TimePoint{} + 240ms));
  EXPECT_TRUE(timeline.between(TimePoint{} + 310ms, TimePoint{} + 350ms));
}

TEST(ShowTimeline, distinguishes_a_still_picture_from_a_moving_one) {
  ShowTimeline timeline(small_projector(), 1);
  const auto step_at = [](int x) {
    RgbImage picture(8, 4);
    for (int y = 0; y < 4; ++y) {
      for (int i = x; i < 8; ++i) *picture.at(i, y) = 255;
    }
    return std::make_shared<const RgbImage>(std::move(picture));
  };
  timeline.add({0, TimePoint{} + 100ms, step_at(3), 1});
  timeline.add({0, TimePoint{} + 200ms, step_at(3), 2});
  timeline.add({0, TimePoint{} + 300ms, step_at(5), 3});
  timeline.known_until({0, TimePoint{} + 290ms, 2});
  EXPECT_TRUE(timeline.is_still(TimePoint{} + 150ms, TimePoint{} + 250ms));
  timeline.known_until({0, TimePoint{} + 400ms, 3});
  EXPECT_FALSE(timeline.is_still(TimePoint{} + 150ms, TimePoint{} + 250ms)) << "it moved since";
  EXPECT_TRUE(timeline.is_still(TimePoint{} + 310ms, TimePoint{} + 390ms));
  EXPECT_FALSE(timeline.is_still(TimePoint{} + 310ms, TimePoint{} + 500ms)) << "not known";
}

std::vector<PatchShift> patches_off_by(std::vector<double> off_px) {
  std::vector<PatchShift> patches;
  for (std::size_t i = 0; i < off_px.size(); ++i) {
    for (int k = 0; k < 12; ++k) {
      PatchShift patch;
      patch.projector = static_cast<int>(i);
      patch.fit = off_px[i] < 4.0 ? PatchFit::kFits : PatchFit::kDiffers;
      patch.shift = {off_px[i], 0.0};
      patches.push_back(patch);
    }
  }
  return patches;
}

TEST(ExposureTiming, distinguishes_a_wrong_clock_from_a_bump) {
  const auto judged = [](std::vector<double> said, std::vector<double> earlier, std::vector<double> later) {
    const std::size_t count = said.size();
    return estimate_timing(patches_off_by(std::move(said)), patches_off_by(std::move(earlier)),
                           patches_off_by(std::move(later)), count);
  };
  EXPECT_TRUE(judged({0.1, 0.1, 0.1}, {1.1, 1.0, 1.2}, {1.1, 1.1, 1.1}).is_its_own);
  EXPECT_TRUE(judged({0.1, 4.0, 0.1}, {1.1, 4.0, 1.2}, {1.1, 4.0, 1.1}).is_its_own) << "the second was bumped";
  EXPECT_TRUE(judged({0.1, 2.0, 0.1}, {1.1, 1.0, 1.2}, {1.1, 3.0, 1.1}).is_its_own) << "alike, and towards there";
  const ExposureTiming late = judged({2.0, 2.0, 2.1}, {3.0, 3.0, 3.1}, {1.0, 1.0, 1.0});
  EXPECT_FALSE(late.is_its_own);
  EXPECT_EQ(late.towards, 1);
  EXPECT_EQ(judged({2.0, 2.0}, {1.0, 1.0}, {3.0, 3.0}).towards, -1);
  const ExposureTiming far = judged({4.0, 4.0, 4.0}, {4.0, 4.0, 4.0}, {4.0, 4.0, 4.0});
  EXPECT_FALSE(far.is_its_own);
  EXPECT_EQ(far.towards, 0);
  EXPECT_FALSE(estimate_timing({}, {}, {}, 3).is_its_own);
}

}  // namespace
}  // namespace cyclorama::healing
