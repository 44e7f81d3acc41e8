// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/as_sold.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "drivers/simulated/museum/presets.h"
#include "drivers/simulated/museum/simulated_museum.h"
#include "drivers/simulated/museum/true_museum.h"

namespace cyclorama::simulated {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 180;
constexpr double kExposure_s = 0.02;

Preset small_preset() {
  PresetOptions options;
  options.projector_width_px = kWidth;
  options.projector_height_px = kHeight;
  options.camera_megapixels = 0.05;
  Preset preset = *make_preset("cylinder126", 3, options);
  preset.truth.cells = 24;
  preset.truth.camera.bits = 12;
  preset.truth.camera.has_shot_noise = false;
  preset.truth.camera.read_noise_e = 0.0;
  preset.truth.turntable.jitter_rad = 0.0;
  return preset;
}

/// Returns a picture whose rectangle in the middle has a colour.
RgbImage patch(std::uint8_t red, std::uint8_t green, std::uint8_t blue) {
  RgbImage picture(kWidth, kHeight);
  for (int y = kHeight / 3; y < 2 * kHeight / 3; ++y) {
    for (int x = kWidth / 3; x < 2 * kWidth / 3; ++x) {
      std::uint8_t* const pixel = picture.at(x, y);
      pixel[0] = red;
      pixel[1] = green;
      pixel[2] = blue;
    }
  }
  return picture;
}

GreyPhotograph photograph(const MuseumTruth& truth, const RgbImage& picture, double wait_s = 0.0) {
  const Preset preset = small_preset();
  SimulatedMuseum museum = *SimulatedMuseum::make(preset.installation, truth, 1);
  CHECK(museum.show(1, picture).has_value());
  museum.settle();
  museum.wait(wait_s);
  return *museum.photograph_grey(kExposure_s);
}

double sum(const GreyPhotograph& codes) { return std::accumulate(codes.data().begin(), codes.data().end(), 0.0); }

/// Returns the largest difference of two photographs, in codes.
int apart(const GreyPhotograph& a, const GreyPhotograph& b) {
  int most = 0;
  for (std::size_t i = 0; i < a.data().size(); ++i)
    most = std::max(most, std::abs(static_cast<int>(a.data()[i]) - static_cast<int>(b.data()[i])));
  return most;
}

class AsSold : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, AsSold, ::testing::ValuesIn(as_sold_kinds()),
                         [](const auto& kind) { return kind.param; });

TEST_P(AsSold, changes_the_museum_and_survives_a_round_trip) {
  Preset preset = small_preset();
  const std::string before = preset.truth.text();
  ASSERT_TRUE(add_as_sold(RandomStream(3), GetParam(), &preset.truth));
  const std::string after = preset.truth.text();
  EXPECT_NE(before, after);
  const auto back = MuseumTruth::parse(after, "truth.toml");
  ASSERT_TRUE(back) << back.error().message();
  EXPECT_EQ(back->text(), after);
  // A museum with it still shows and sees something.
  const GreyPhotograph codes = photograph(preset.truth, patch(255, 255, 255));
  EXPECT_GT(*std::ranges::max_element(codes.data()), (1 << preset.truth.camera.bits) / 8);
}

TEST(AsSoldKinds, an_unknown_one_is_refused) {
  Preset preset = small_preset();
  const auto added = add_as_sold(RandomStream(3), "perfect", &preset.truth);
  ASSERT_FALSE(added);
  EXPECT_THAT(added.error().message(), testing::HasSubstr("'perfect'; there are decentred"));
}

TEST(AsSoldLens, waves_are_inverted_and_differentiated) {
  Preset preset = small_preset();
  ASSERT_TRUE(add_as_sold(RandomStream(5), "residue", &preset.truth));
  const TrueLens& lens = preset.truth.projectors[0].lens;
  const TrueLens plain(lens.pinhole(), lens.radial(), lens.tangential());
  double largest_px = 0.0;
  for (int row = 0; 11 * row + 2.5 < kHeight; ++row) {
    for (int column = 0; 11 * column + 2.5 < kWidth; ++column) {
      const double u = 11 * column + 2.5;
      const double v = 11 * row + 2.5;
      const auto direction = lens.direction_at(u, v);
      ASSERT_TRUE(direction);
      EXPECT_NEAR((*lens.pixel_of(*direction) - Eigen::Vector2d(u, v)).norm(), 0.0, 1e-9);
      largest_px = std::max(largest_px, (*plain.pixel_of(*direction) - Eigen::Vector2d(u, v)).norm());
      const Eigen::Vector2d ideal = direction->head<2>();
      constexpr double kStep = 1e-6;
      for (int axis = 0; axis < 2; ++axis) {
        const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(axis);
        const Eigen::Vector2d slope = (lens.distorted(ideal + step) - lens.distorted(ideal - step)) / (2.0 * kStep);
        EXPECT_NEAR((lens.derivative(ideal).col(axis) - slope).norm(), 0.0, 1e-6);
      }
    }
  }
  // At most .6 px at 1080 rows, a sixth of which these pictures have.
  EXPECT_LE(largest_px, 0.1);
  EXPECT_GE(largest_px, 0.03);
}

TEST(AsSoldProjector, moves_while_it_warms_up) {
  Preset preset = small_preset();
  preset.truth.projectors[1].drift_px = {3.0, -2.0};
  const GreyPhotograph cold = photograph(preset.truth, patch(255, 255, 255));
  const GreyPhotograph warm = photograph(preset.truth, patch(255, 255, 255), 7200.0);
  const GreyPhotograph always_warm = photograph(preset.truth.warmed_up(7200.0), patch(255, 255, 255));
  EXPECT_GT(apart(cold, warm), 500);
  EXPECT_LE(apart(warm, always_warm), 40);
  EXPECT_NEAR(preset.truth.projectors[1].drift_at(600.0).x(), 3.0 * (1.0 - std::exp(-1.0)), 1e-12);
}

TEST(AsSoldProjector, lateral_colour_moves_red_and_blue_but_not_green) {
  const Preset preset = small_preset();
  MuseumTruth truth = preset.truth;
  truth.projectors[1].lateral_colour = {0.03, -0.03};
  EXPECT_EQ(apart(photograph(truth, patch(0, 255, 0)), photograph(preset.truth, patch(0, 255, 0))), 0);
  const double red = sum(photograph(truth, patch(255, 0, 0))) - sum(photograph(preset.truth, patch(255, 0, 0)));
  const double blue = sum(photograph(truth, patch(0, 0, 255))) - sum(photograph(preset.truth, patch(0, 0, 255)));
  EXPECT_GT(red, 0.0);
  EXPECT_LT(blue, 0.0);
}

TEST(AsSoldProjector, a_white_segment_adds_light_to_white_alone) {
  const Preset preset = small_preset();
  MuseumTruth truth = preset.truth;
  for (TrueProjector& p : truth.projectors) p.black = {};
  MuseumTruth with = truth;
  with.projectors[1].white_segment = 0.5;
  EXPECT_EQ(apart(photograph(with, patch(255, 0, 0)), photograph(truth, patch(255, 0, 0))), 0);
  EXPECT_EQ(apart(photograph(with, patch(255, 255, 0)), photograph(truth, patch(255, 255, 0))), 0);
  EXPECT_GT(sum(photograph(with, patch(200, 200, 200))), 1.1 * sum(photograph(truth, patch(200, 200, 200))));
  const TrueMuseum museum = *TrueMuseum::make(preset.installation, with);
  const TrueMuseum without = *TrueMuseum::make(preset.installation, truth);
  EXPECT_NEAR(museum.colour_of(1, {255, 255, 255})[1], 1.5 * without.colour_of(1, {255, 255, 255})[1], 1e-9);
}

TEST(AsSoldCamera, a_pipeline_changes_codes_and_a_plain_one_none) {
  const GreyPhotograph plain = photograph(small_preset().truth, patch(255, 255, 255));
  GreyPhotograph same = plain;
  CameraPipeline{}.apply(&same, 4095);
  EXPECT_EQ(same, plain);
  GreyPhotograph sharp = plain;
  CameraPipeline{.sharpening = 1.0}.apply(&sharp, 4095);
  EXPECT_GT(apart(sharp, plain), 100);
  GreyPhotograph packed = plain;
  CameraPipeline{.jpeg_quality = 80}.apply(&packed, 4095);
  EXPECT_GT(apart(packed, plain), 16);
  EXPECT_NEAR(sum(packed) / sum(plain), 1.0, 0.02);
}

TEST(AsSoldCamera, exposes_as_it_likes) {
  Preset preset = small_preset();
  ASSERT_TRUE(add_as_sold(RandomStream(3), "exposure", &preset.truth));
  SimulatedMuseum museum = *SimulatedMuseum::make(preset.installation, preset.truth, 1);
  RgbImage grey(kWidth, kHeight);
  std::ranges::fill(grey.data(), static_cast<std::uint8_t>(120));
  for (std::size_t i = 0; i < 3; ++i) ASSERT_TRUE(museum.show(i, grey));
  museum.settle();
  for (const double asked_s : {0.001, 0.02, 0.2}) {
    GreyPhotograph codes;
    for (int i = 0; i < 12; ++i) codes = *museum.photograph_grey(asked_s);
    EXPECT_NEAR(sum(codes) / static_cast<double>(codes.data().size()) / 4095.0, 0.4, 0.05) << asked_s;
  }
}

TEST(AsSoldRoom, paint_daylight_and_mount_show_in_photographs) {
  const Preset preset = small_preset();
  RgbImage white(kWidth, kHeight);
  std::ranges::fill(white.data(), static_cast<std::uint8_t>(255));
  const GreyPhotograph plain = photograph(preset.truth, white);
  MuseumTruth painted = preset.truth;
  painted.paint.panels.push_back({0.0, 1.0, 0.0, 1.0, 0.5, 0.0});
  EXPECT_NEAR(sum(photograph(painted, white)) / sum(plain), 0.55, 0.15);
  MuseumTruth day = preset.truth;
  day.daylight_lux = {300.0, 300.0, 300.0};
  EXPECT_LE(apart(photograph(day, white), plain), 30);
  EXPECT_GT(sum(photograph(day, white, 300.0)), 1.1 * sum(plain));
  MuseumTruth loose = preset.truth;
  loose.turntable.creep_px_per_h = {60.0, 0.0};
  EXPECT_GT(apart(photograph(loose, white, 120.0), plain), 200);
}

}  // namespace
}  // namespace cyclorama::simulated
