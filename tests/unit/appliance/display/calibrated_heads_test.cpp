// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/calibrated_heads.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "appliance/calibration/calibration_file.h"
#include "tests/data_sets/demo_room.h"
#include "tests/data_sets/exact_calibration.h"

namespace cyclorama::display {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kDate = "2026-01-01T00-00-00Z";

class CalibratedHeadsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string folder = ::testing::TempDir() + "/calibrated.XXXXXX";
    ASSERT_NE(::mkdtemp(folder.data()), nullptr);
    folder_ = folder;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  Result<CalibratedHeads> heads() {
    auto planned = planned_heads(room_, picture_);
    CHECK(planned.has_value());
    return calibrated_heads(folder_, room_, picture_, *std::move(planned));
  }

  Installation room_ = demo_room_with_pixels_over(4);
  PictureShape picture_ = room_.picture(1024);
  std::filesystem::path folder_;
};

TEST_F(CalibratedHeadsTest, agree_with_the_installation_after_an_exact_calibration) {
  ASSERT_TRUE(calibration::save_calibration(folder_, exact_calibration(room_, kDate)));
  const auto made = heads();
  ASSERT_TRUE(made) << made.error().message();
  EXPECT_EQ(made->date, kDate);
  EXPECT_TRUE(made->lacking.empty());
  const auto planned = planned_heads(room_, picture_);
  ASSERT_TRUE(planned);
  const PixelScale scale = pixel_scale(picture_);
  for (std::size_t i = 0; i < planned->size(); ++i) {
    const HeadPlan& is = made->heads[i];
    const HeadPlan& should = (*planned)[i];
    double max_shift_px = 0.0;
    double worst_mask = 0.0;
    for (int y = 0; y < is.mask.height(); ++y) {
      for (int x = 0; x < is.mask.width(); ++x) {
        if (!(*should.mask.at(x, y) > 0.0f)) continue;  // Beside the wall; the map ends where the mask does.
        const auto a = direction_at(is.warp, x, y);
        const auto b = direction_at(should.warp, x, y);
        ASSERT_TRUE(a && b);
        max_shift_px = std::max(
            max_shift_px, scale.distance_px({a->azimuth_rad, a->tan_elevation}, {b->azimuth_rad, b->tan_elevation}));
        worst_mask = std::max(worst_mask, std::abs(static_cast<double>(*is.mask.at(x, y) - *should.mask.at(x, y))));
      }
    }
    EXPECT_LT(max_shift_px, 0.1) << "cells of four pixels, straight lines within";
    EXPECT_LT(worst_mask, 0.01) << room_.projectors[i].name;
  }
}

TEST_F(CalibratedHeadsTest, have_weights_that_add_up_to_one_on_the_wall) {
  ASSERT_TRUE(calibration::save_calibration(folder_, exact_calibration(room_, kDate)));
  const auto made = heads();
  ASSERT_TRUE(made) << made.error().message();
  const std::vector<warp::ProjectorMap> maps = warp::projector_maps(room_);
  const auto weight_at = [&](std::size_t i, const Eigen::Vector2d& pixel) {
    const warp::MaskImage& mask = made->heads[i].mask;
    const double u = std::clamp(pixel.x() - 0.5, 0.0, mask.width() - 1.0);
    const double v = std::clamp(pixel.y() - 0.5, 0.0, mask.height() - 1.0);
    const int x = std::min(static_cast<int>(u), mask.width() - 2);
    const int y = std::min(static_cast<int>(v), mask.height() - 2);
    const auto row = [&](int at) {
      return (1.0 - (u - x)) * static_cast<double>(*mask.at(x, at)) +
             (u - x) * static_cast<double>(*mask.at(x + 1, at));
    };
    return (1.0 - (v - y)) * row(y) + (v - y) * row(y + 1);
  };
  int blended = 0;
  double worst = 0.0;
  for (int y = 12; y < 108; ++y) {
    for (int x = 4; x < 156; ++x) {
      const auto point = maps[1].wall_point_of({x + 0.5, y + 0.5});
      const auto left = point ? maps[0].pixel_lighting(*point) : std::nullopt;
      if (!left || left->y() < 4.0 || left->y() > 116.0) continue;
      worst = std::max(worst, std::abs(weight_at(1, {x + 0.5, y + 0.5}) + weight_at(0, *left) - 1.0));
      ++blended;
    }
  }
  EXPECT_GT(blended, 500);
  EXPECT_LT(worst, 0.005) << "of heads of 160 pixels, whose masks are read between pixels here";
}

TEST_F(CalibratedHeadsTest, use_the_masks_and_colours_of_the_calibrations_folder) {
  std::vector<calibration::CalibratedColour> colours;
  for (const InstalledProjector& projector : room_.projectors) {
    calibration::CalibratedColour one{
        projector.name, warp::MaskImage(projector.lens.width_px, projector.lens.height_px, 0.25f), {}};
    one.colour.matrix = 0.5 * Eigen::Matrix3d::Identity();
    one.colour.response = {warp::ResponseCurve::power(2.2, 64), warp::ResponseCurve::power(2.0, 64),
                           warp::ResponseCurve::srgb(64)};
    one.colour.black = {0.01, 0.02, 0.03};
    one.colour.black_lift = warp::BlackLiftImage(projector.lens.width_px, projector.lens.height_px, 0.5f);
    colours.push_back(std::move(one));
  }
  colours.pop_back();  // The last projector has no measured colours.
  ASSERT_TRUE(calibration::save_calibration(folder_, exact_calibration(room_, kDate), colours));
  const auto made = heads();
  ASSERT_TRUE(made) << made.error().message();
  EXPECT_NEAR(*made->heads[0].mask.at(10, 10), 0.25, 1e-5);
  EXPECT_EQ(made->heads[0].colour.black, Eigen::Vector3d(0.01, 0.02, 0.03));
  ASSERT_TRUE(made->heads[0].colour.black_lift && made->heads[0].colour.response && made->heads[0].colour.matrix);
  EXPECT_NEAR(*made->heads[0].colour.black_lift->at(3, 3), 0.5, 1e-5);
  EXPECT_EQ((*made->heads[0].colour.response)[1].codes, warp::ResponseCurve::power(2.0, 64).codes);
  EXPECT_FALSE(made->heads.back().colour.response) << "sRGB, blended by its map";
  // The size differs from the head's.
  colours[0].mask = warp::MaskImage(8, 8, 1.0f);
  ASSERT_TRUE(calibration::save_calibration(folder_, exact_calibration(room_, "2026-01-02T00-00-00Z"), colours));
  const auto wrong = heads();
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().message(), HasSubstr("8x8"));
}

TEST_F(CalibratedHeadsTest, keep_the_planned_map_of_a_projector_that_was_not_seen) {
  calibration::Calibration calibration = exact_calibration(room_, kDate);
  calibration.projectors[1].name = "attic";
  ASSERT_TRUE(calibration::save_calibration(folder_, calibration));
  const auto made = heads();
  ASSERT_TRUE(made) << made.error().message();
  EXPECT_THAT(made->lacking, ElementsAre(room_.projectors[1].name));
  const auto planned = planned_heads(room_, picture_);
  EXPECT_EQ(made->heads[1].mask, (*planned)[1].mask);
}

TEST_F(CalibratedHeadsTest, refuse_a_calibration_of_other_projectors_and_report_a_missing_one) {
  EXPECT_EQ(heads().error().code(), ErrorCode::kNotFound);
  calibration::Calibration others = exact_calibration(room_, kDate);
  for (calibration::CalibratedProjector& projector : others.projectors) projector.name += "2";
  ASSERT_TRUE(calibration::save_calibration(folder_, others));
  EXPECT_EQ(heads().error().code(), ErrorCode::kInvalidArgument);
  ASSERT_TRUE(
      calibration::save_calibration(folder_, exact_calibration(demo_room_with_pixels_over(2), "2026-01-03T00-00-00Z")));
  const auto larger = heads();
  ASSERT_FALSE(larger);
  EXPECT_EQ(larger.error().code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(larger.error().message(), HasSubstr("320x240"));
}

TEST_F(CalibratedHeadsTest, stretch_the_map_over_each_eyes_pixels_side_by_side) {
  ASSERT_TRUE(calibration::save_calibration(folder_, exact_calibration(room_, kDate)));
  room_.stereo.emplace();
  room_.stereo->packing = StereoPacking::kSideBySide;
  const auto made = heads();
  ASSERT_TRUE(made) << made.error().message();
  EXPECT_EQ(width_px(made->heads[0].warp), room_.projectors[0].lens.width_px / 2);
  EXPECT_EQ(made->heads[0].mask.width(), room_.projectors[0].lens.width_px / 2);
  EXPECT_EQ(made->heads[0].packing, StereoPacking::kSideBySide);
}

}  // namespace
}  // namespace cyclorama::display
