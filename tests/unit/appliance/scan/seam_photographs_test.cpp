// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/seam_photographs.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <numbers>
#include <numeric>

#include "appliance/scan/head_drawing.h"
#include "appliance/scan/simulated_devices.h"
#include "common/image/jpeg.h"
#include "drivers/simulated/museum/presets.h"
#include "drivers/simulated/museum/true_museum.h"
#include "drivers/simulated/turntable/simulated_turntable.h"

namespace cyclorama::scan {
namespace {

using ::testing::HasSubstr;

TEST(TestLight, has_lines_every_two_degrees_of_which_every_fifth_is_brighter) {
  const auto at = [](double azimuth_deg, double elevation_deg) {
    const double a = azimuth_deg * std::numbers::pi / 180.0;
    const double e = elevation_deg * std::numbers::pi / 180.0;
    return test_light(TestPicture::kLines, {std::cos(e) * std::sin(a), std::sin(e), -std::cos(e) * std::cos(a)});
  };
  EXPECT_DOUBLE_EQ(at(10.0, 3.0), 1.0);
  EXPECT_DOUBLE_EQ(at(3.0, -20.0), 1.0);
  EXPECT_GT(at(12.0, 3.0), 0.4);
  EXPECT_LT(at(12.0, 3.0), 0.5);
  EXPECT_LT(at(11.0, 3.0), 0.05);
  EXPECT_DOUBLE_EQ(test_light(TestPicture::kWhite, {1, 0, 0}), 1.0);
}

TEST(DrawnHead, masks_light_rather_than_codes_and_is_dark_without_a_direction) {
  warp::MaskImage mask(16, 2, 0.5f);
  DrawnHead head{16, 2, {}, &mask, nullptr};
  head.direction_at = [](const Eigen::Vector2d& pixel) -> std::optional<Eigen::Vector3d> {
    if (pixel.x() < 8.0) return std::nullopt;
    return Eigen::Vector3d(0, 0, -1);
  };
  const RgbImage drawn = drawn_head(head, TestPicture::kWhite);
  EXPECT_EQ(drawn.at(3, 0)[0], 0);
  EXPECT_NEAR(drawn.at(12, 1)[1], 188, 1) << "half of the light in sRGB";
  warp::HeadColour colour;
  colour.matrix = Eigen::Vector3d(1.0, 0.5, 0.0).asDiagonal();
  colour.response = {warp::ResponseCurve::power(1.0, 64), warp::ResponseCurve::power(1.0, 64),
                     warp::ResponseCurve::power(1.0, 64)};
  head.colour = &colour;
  const RgbImage coloured = drawn_head(head, TestPicture::kWhite);
  EXPECT_NEAR(coloured.at(12, 1)[0], 128, 2);
  EXPECT_NEAR(coloured.at(12, 1)[1], 64, 2);
  EXPECT_EQ(coloured.at(12, 1)[2], 0);
}

/// A small museum whose maps are exact.
class SeamPhotographsTest : public ::testing::Test {
 protected:
  SeamPhotographsTest() {
    simulated::PresetOptions options;
    options.projectors = 3;
    options.projector_width_px = 160;
    options.projector_height_px = 100;
    options.camera_megapixels = 0.1;
    preset_ = *simulated::make_preset("cylinder126", 4, options);
    museum_.emplace(*simulated::SimulatedMuseum::make(preset_.installation, preset_.truth));
    for (std::size_t p = 0; p < 3; ++p) {
      std::vector<solve::MapSample> samples;
      for (int y = 2; y < 100; y += 4) {
        for (int x = 2; x < 160; x += 4) {
          const auto d = museum_->truth().direction_at(p, x, y, museum_->truth().turning_point());
          if (d) samples.push_back({Eigen::Vector2d(x, y), *d, 0.05});
        }
      }
      calibration_.projectors.push_back(
          {preset_.installation.projectors[p].name, *solve::fit_measured_map(160, 100, samples), false});
    }
  }
  simulated::Preset preset_;
  std::optional<simulated::SimulatedMuseum> museum_;
  calibration::Calibration calibration_;
};

TEST_F(SeamPhotographsTest, takes_four_of_each_seam_and_leaves_the_wall_dark) {
  SimulatedPatternScreen screen(&*museum_);
  SimulatedScanCamera camera(&*museum_, PhotographColour::kGrey);
  simulated::SimulatedTurntable turntable(&*museum_);
  ASSERT_TRUE(turntable.home().has_value());
  const ScanPhotograph dark = *camera.photograph(0.03);
  const double begun_s = museum_->now_s();
  const auto seams = photograph_seams(preset_.installation, {"before", nullptr, {}}, {"after", &calibration_, {}}, 0.03,
                                      {screen, camera, turntable}, {}, {});
  ASSERT_TRUE(seams.has_value()) << seams.error().message();
  ASSERT_EQ(seams->photographs.size(), 8u) << "of two seams";
  EXPECT_LT(museum_->now_s() - begun_s, 8.0);
  EXPECT_THAT(seams->photographs[0].caption, HasSubstr("lines before"));
  EXPECT_THAT(seams->photographs[3].caption, HasSubstr("white after"));
  JpegDecoder decoder;
  for (const auto& photograph : seams->photographs) {
    EXPECT_LT(photograph.jpeg.size(), 120000u);
    const auto picture = decoder.decode(photograph.jpeg, 1 << 20);
    ASSERT_TRUE(picture.has_value());
    const auto codes = picture->data();
    EXPECT_GT(*std::max_element(codes.begin(), codes.end()), 60) << photograph.caption;
    EXPECT_LT(std::count(codes.begin(), codes.end(), 255), static_cast<std::ptrdiff_t>(codes.size() / 50));
  }
  ASSERT_TRUE(turntable.turn_to(0.0).has_value());
  const ScanPhotograph afterwards = *camera.photograph(0.03);
  const auto sum = [](const ScanPhotograph& p) { return std::accumulate(p.data().begin(), p.data().end(), 0.0); };
  EXPECT_NEAR(sum(afterwards) / sum(dark), 1.0, 0.05);
}

TEST_F(SeamPhotographsTest, ends_at_once_when_cancelled) {
  SimulatedPatternScreen screen(&*museum_);
  SimulatedScanCamera camera(&*museum_, PhotographColour::kGrey);
  simulated::SimulatedTurntable turntable(&*museum_);
  std::stop_source stop;
  stop.request_stop();
  const auto seams = photograph_seams(preset_.installation, {"before", nullptr, {}}, {"after", &calibration_, {}}, 0.03,
                                      {screen, camera, turntable}, {}, stop.get_token());
  ASSERT_FALSE(seams.has_value());
  EXPECT_EQ(seams.error().code(), ErrorCode::kUnavailable);
}

}  // namespace
}  // namespace cyclorama::scan
