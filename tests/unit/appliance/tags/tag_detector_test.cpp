// SPDX-License-Identifier: Apache-2.0
#include "appliance/tags/tag_detector.h"

#include <apriltag/apriltag.h>
#include <apriltag/common/image_u8.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagCircle49h12.h>
#include <apriltag/tagCustom48h12.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <random>

#include "appliance/tracker/tag_pose.h"
#include "tests/data_sets/painted_tag.h"

namespace cyclorama::tags {
namespace {

const Pinhole kLens = Pinhole::from_field_of_view(640, 480, 1.0472);

TagDetector detector_of(const DetectorSettings& settings) {
  auto detector = TagDetector::create(settings);
  EXPECT_TRUE(detector.has_value()) << detector.error().message();
  return *std::move(detector);
}

std::vector<TagDetection> found_in(const GreyImage& picture, TagDetector* detector) {
  auto found = detector->detect(picture);
  EXPECT_TRUE(found.has_value()) << found.error().message();
  return found ? *std::move(found) : std::vector<TagDetection>{};
}

struct Precision {
  double decimate;
  bool refine_corners;
  double max_error_px;
};
class Decimation : public testing::TestWithParam<Precision> {};

/// Checks our definitions of pixels and corner order, independent of libapriltag's.
TEST_P(Decimation, a_corner_lands_where_it_was_painted) {
  DetectorSettings settings;
  settings.decimate = GetParam().decimate;
  settings.refine_corners = GetParam().refine_corners;
  TagDetector detector = detector_of(settings);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  constexpr int kPoses = 100;
  Eigen::Vector2d bias = Eigen::Vector2d::Zero();
  double squares = 0.0;
  for (int i = 0; i < kPoses; ++i) {
    const Eigen::Quaterniond turn = Eigen::AngleAxisd(0.4 * any(random), Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(0.4 * any(random), Eigen::Vector3d::UnitX()) *
                                    Eigen::AngleAxisd(0.8 * any(random), Eigen::Vector3d::UnitZ());
    const tracker::T_CameraTag pose(turn, {0.15 * any(random), 0.1 * any(random), 0.8 + 0.2 * any(random)});
    const auto found = found_in(painted_tag(7, pose, kLens), &detector);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].id, 7);
    EXPECT_GT(doubled_area_px2(found[0].corners), 0.0);
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const auto truth = kLens.pixel_of((pose * Point<frame::Tag>{tracker::corners_of_tag(0.12)[corner]}).xyz);
      ASSERT_TRUE(truth.has_value());
      const Eigen::Vector2d error = found[0].corners[corner] - *truth;
      EXPECT_LT(error.norm(), 0.5);
      bias += error / (4.0 * kPoses);
      squares += error.squaredNorm() / (4.0 * kPoses);
    }
  }
  // A convention that is wrong by half a pixel would show as 0.5.
  EXPECT_LT(bias.norm(), 0.01);
  EXPECT_LT(std::sqrt(squares), GetParam().max_error_px);
}
INSTANTIATE_TEST_SUITE_P(All, Decimation,
                         testing::Values(Precision{1.0, false, 0.12}, Precision{3.0, false, 0.12},
                                         Precision{1.0, true, 0.04}, Precision{1.5, true, 0.04},
                                         Precision{2.0, true, 0.04}, Precision{3.0, true, 0.04}));

TEST(TagDetector, finds_nothing_in_pictures_that_are_too_small) {
  for (const double decimate : {1.0, 1.5, 2.0, 8.0}) {
    DetectorSettings settings;
    settings.decimate = decimate;
    TagDetector detector = detector_of(settings);
    for (const auto& [width, height] :
         {std::pair{0, 0}, {1, 1}, {1, 5000}, {5000, 1}, {7, 7}, {8, 8}, {9, 12}, {17, 16}, {31, 33}}) {
      for (const std::uint8_t grey : {std::uint8_t{0}, std::uint8_t{255}}) {
        EXPECT_TRUE(found_in(GreyImage(width, height, grey), &detector).empty()) << width << "x" << height;
      }
    }
  }
}

TEST(TagDetector, refuses_a_picture_whose_half_pixels_do_not_fit_16_bits) {
  TagDetector detector = detector_of({});
  EXPECT_FALSE(detector.detect(GreyImage(TagDetector::kMaxSidePx + 1, 64)).has_value());
  EXPECT_TRUE(detector.detect(GreyImage(TagDetector::kMaxSidePx, 64)).has_value());
}

TEST(TagDetector, finds_a_tag_in_the_far_corner_of_a_huge_picture) {
  const Pinhole far{9000, 7000, 6000.0, 4500.0, 3500.0};
  DetectorSettings settings;
  settings.decimate = 4.0;
  TagDetector detector = detector_of(settings);
  const tracker::T_CameraTag pose(Eigen::Quaterniond::Identity(), {0.65, 0.40, 1.0});
  const auto found = found_in(painted_tag(11, pose, far), &detector);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].corners[0].x(), 4500 + 6000 * 0.59, 0.5);
  EXPECT_NEAR(found[0].corners[0].y(), 3500 + 6000 * 0.34, 0.5);
}

TEST(TagDetector, finds_a_tag_that_fills_the_picture_and_none_that_leaves_it) {
  TagDetector detector = detector_of({});
  const double z = 0.12 * kLens.focal_px / 380.0;  // 380 of 480 pixels, with the white border just inside.
  EXPECT_EQ(found_in(painted_tag(5, {Eigen::Quaterniond::Identity(), {0, 0, z}}, kLens), &detector).size(), 1U);
  EXPECT_TRUE(found_in(painted_tag(5, {Eigen::Quaterniond::Identity(), {0, 0, 0.06}}, kLens), &detector).empty());
}

TEST(TagDetector, survives_noise) {
  TagDetector detector = detector_of({});
  std::mt19937 random(1);
  for (int i = 0; i < 10; ++i) {
    GreyImage noise(300 + i, 200);
    for (std::uint8_t& grey : noise.data()) grey = static_cast<std::uint8_t>(random() % 256);
    EXPECT_TRUE(found_in(noise, &detector).empty());
  }
}

struct PrintedFamily {
  const char* name;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};

/// The same as image_u8_destroy(), which Debian's library does not export.
void destroy_image(image_u8_t* image) {
  std::free(image->buf);
  std::free(image);
}

class EveryFamily : public testing::TestWithParam<PrintedFamily> {};

/// A tag as libapriltag prints it, each cell 12 pixels wide, with a white margin.
TEST_P(EveryFamily, is_read_with_its_corners_at_the_border) {
  constexpr int kCell = 12;
  constexpr int kMargin = 40;
  const std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)> family(GetParam().create(),
                                                                                GetParam().destroy);
  ASSERT_NE(std::find(tag_families().begin(), tag_families().end(), GetParam().name), tag_families().end());
  DetectorSettings settings;
  settings.family = GetParam().name;
  settings.decimate = 1.0;
  TagDetector detector = detector_of(settings);
  const int last = static_cast<int>(family->ncodes) - 1;
  for (const int id : {0, last / 2, last}) {
    // 16 bits: Debian 12's library takes an int here, Debian 13's an unsigned.
    const std::unique_ptr<image_u8_t, void (*)(image_u8_t*)> printed(
        apriltag_to_image(family.get(), static_cast<std::uint16_t>(id)), destroy_image);
    GreyImage picture(printed->width * kCell + 2 * kMargin, printed->height * kCell + 2 * kMargin, 255);
    for (int y = 0; y < printed->height * kCell; ++y) {
      for (int x = 0; x < printed->width * kCell; ++x) {
        *picture.at(x + kMargin, y + kMargin) = printed->buf[y / kCell * printed->stride + x / kCell];
      }
    }
    const auto found = found_in(picture, &detector);
    ASSERT_EQ(found.size(), 1U) << id;
    EXPECT_EQ(found[0].id, id);
    const int border = (family->total_width - family->width_at_border) / 2;
    const double near = kMargin + kCell * border;
    const double far = near + kCell * family->width_at_border;
    const std::array<Eigen::Vector2d, 4> painted{Eigen::Vector2d(near, near), Eigen::Vector2d(far, near),
                                                 Eigen::Vector2d(far, far), Eigen::Vector2d(near, far)};
    for (std::size_t i = 0; i < 4; ++i) EXPECT_LT((found[0].corners[i] - painted[i]).norm(), 0.05) << id << ", " << i;
    EXPECT_LT(found[0].covariance[0](0, 0), TagDetection::kUnrefined(0, 0)) << "the corners were not refined";
  }
}
INSTANTIATE_TEST_SUITE_P(
    OfLibapriltag, EveryFamily,
    testing::Values(PrintedFamily{"tag36h11", tag36h11_create, tag36h11_destroy},
                    PrintedFamily{"tag25h9", tag25h9_create, tag25h9_destroy},
                    PrintedFamily{"tag16h5", tag16h5_create, tag16h5_destroy},
                    PrintedFamily{"tag36h10", tag36h10_create, tag36h10_destroy},
                    PrintedFamily{"tagStandard41h12", tagStandard41h12_create, tagStandard41h12_destroy},
                    PrintedFamily{"tagStandard52h13", tagStandard52h13_create, tagStandard52h13_destroy},
                    PrintedFamily{"tagCircle21h7", tagCircle21h7_create, tagCircle21h7_destroy},
                    PrintedFamily{"tagCircle49h12", tagCircle49h12_create, tagCircle49h12_destroy},
                    PrintedFamily{"tagCustom48h12", tagCustom48h12_create, tagCustom48h12_destroy}),
    [](const auto& family) { return std::string(family.param.name); });

TEST(TagDetector, refuses_wrong_settings_and_lists_the_families) {
  const auto refusal = [](auto change) {
    DetectorSettings settings;
    change(&settings);
    const auto detector = TagDetector::create(settings);
    EXPECT_FALSE(detector.has_value());
    return detector ? "" : detector.error().message();
  };
  EXPECT_THAT(refusal([](DetectorSettings* s) { s->family = "tag99"; }),
              testing::HasSubstr("tag36h11, tag25h9, tag16h5"));
  refusal([](DetectorSettings* s) { s->decimate = std::nan(""); });
  refusal([](DetectorSettings* s) { s->decimate = 0.5; });
  refusal([](DetectorSettings* s) { s->threads = 0; });
  refusal([](DetectorSettings* s) { s->max_hamming = 3; });
  const auto huge = [](DetectorSettings* s) {
    s->family = "tagStandard52h13";
    s->max_hamming = 2;
  };
  EXPECT_THAT(refusal(huge), testing::HasSubstr("48714 codes"));
}

}  // namespace
}  // namespace cyclorama::tags
