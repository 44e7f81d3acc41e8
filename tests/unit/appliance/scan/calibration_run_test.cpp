// SPDX-License-Identifier: Apache-2.0
// The whole chain in small museums: from devices that do not reveal the truth to calibration.json, which is then
// compared with the truth.
#include "appliance/scan/calibration_run.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <numbers>
#include <string_view>

#include "appliance/calibration/calibration_file.h"
#include "appliance/scan/simulated_devices.h"
#include "common/base/file.h"
#include "drivers/simulated/museum/presets.h"
#include "drivers/simulated/turntable/simulated_turntable.h"
#include "tests/data_sets/photometry_museum.h"
#include "tests/support/museum_score.h"

namespace cyclorama::scan {
namespace {

class InFolder : public ::testing::Test {
 protected:
  InFolder() : folder_(std::filesystem::path(::testing::TempDir()) / ("chain-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~InFolder() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  std::filesystem::path folder_;
};
class CalibrationRun : public InFolder, public ::testing::WithParamInterface<const char*> {};
class CalibrationOfLight : public InFolder {};

/// A screen whose projectors show black instead of single colours.
class WithoutColours final : public PatternScreen {
 public:
  explicit WithoutColours(PatternScreen* screen) : screen_(screen) {}
  Status show(std::size_t projector, const RgbImage& picture) override {
    const auto codes = picture.data();
    const bool is_coloured = !codes.empty() && (codes[0] != codes[1] || codes[1] != codes[2]);
    return screen_->show(projector, is_coloured ? RgbImage() : picture);
  }

 private:
  PatternScreen* screen_;
};

MuseumScore score_of(const simulated::SimulatedMuseum& museum, const calibration::Calibration& calibration) {
  return museum_score(museum.truth(), [&](std::size_t p, const Eigen::Vector2d& pixel) {
    return calibration.projectors[p].map.direction_at(pixel);
  });
}

TEST_P(CalibrationRun, aligns_the_projectors_on_the_wall) {
  const bool is_plane = GetParam() == std::string_view("plane");
  simulated::PresetOptions options;
  options.projectors = is_plane ? 2 : 3;
  options.projector_width_px = 240;
  options.projector_height_px = 150;
  options.camera_megapixels = 0.14;
  const auto preset = simulated::make_preset(GetParam(), 3, options);
  ASSERT_TRUE(preset.has_value());
  auto museum = simulated::SimulatedMuseum::make(preset->installation, preset->truth);
  ASSERT_TRUE(museum.has_value());
  SimulatedPatternScreen screen(&*museum);
  SimulatedScanCamera camera(&*museum, PhotographColour::kGrey);
  simulated::SimulatedTurntable turntable(&*museum);
  ScanSettings settings;
  settings.camera = data_sheet_lens(camera.width_px(), camera.height_px(), 70.0 * std::numbers::pi / 180.0);
  double told = 0.0;
  const auto listener = [&](const ScanProgress& progress) {
    EXPECT_GE(progress.fraction, told);
    told = progress.fraction;
  };
  const SteadyClock clock;
  const auto outcome = run_calibration(museum->installation(), settings, {screen, camera, turntable}, folder_,
                                       "2026-01-01T00-00-00Z", clock, listener, {});
  ASSERT_TRUE(outcome.has_value()) << outcome.error().message();
  EXPECT_DOUBLE_EQ(told, 1.0);

  const auto written = calibration::read_calibration(folder_);
  ASSERT_TRUE(written.has_value()) << written.error().message();
  const MuseumScore score = score_of(*museum, *written);
  RecordProperty("p95_px", std::to_string(score.p95_px));
  EXPECT_GT(score.correspondences, 100u);
  // The goals for a projector of 1080p; in its pixels this camera is no coarser.
  EXPECT_LE(score.mean_px, 0.25);
  EXPECT_LE(score.p95_px, 0.6);
  EXPECT_LE(score.max_px, 1.0);
  EXPECT_LT(static_cast<double>(score.missing), 0.05 * static_cast<double>(score.lit));
  // The installer's figures come from measurements alone and include their noise.
  EXPECT_GT(outcome->registration.correspondences, 100u);
  EXPECT_LE(outcome->registration.p95_px, 1.5);

  // Repeated without a model of the wall: no worse than before. Only in one of the rooms, to save time.
  if (is_plane) return;
  settings.with_wall = false;
  const auto again = run_calibration(museum->installation(), settings, {screen, camera, turntable}, folder_,
                                     "2026-01-02T00-00-00Z", clock, {}, {});
  ASSERT_TRUE(again.has_value()) << again.error().message();
  EXPECT_LE(score_of(*museum, again->calibration).p95_px, 0.6);
  EXPECT_EQ(calibration::kept_calibrations(folder_).size(), 2u);
}

simulated::PresetOptions two_small_projectors() {
  simulated::PresetOptions options;
  options.projectors = 2;
  options.projector_width_px = 160;
  options.projector_height_px = 100;
  options.camera_megapixels = 0.1;
  return options;
}

/// The sun through a window, evenly on the wall. The test has the truth; the calibration sees only the light.
TEST_F(CalibrationOfLight, in_daylight_it_is_right_or_refused_with_a_remedy) {
  for (const double lux : {300.0, 3000.0}) {
    auto preset = simulated::make_preset("cylinder126", 5, two_small_projectors());
    ASSERT_TRUE(preset.has_value());
    preset->truth.ambient_lux = {lux, lux, lux};
    auto museum = simulated::SimulatedMuseum::make(preset->installation, preset->truth);
    ASSERT_TRUE(museum.has_value());
    SimulatedPatternScreen screen(&*museum);
    SimulatedScanCamera camera(&*museum, PhotographColour::kGrey);
    simulated::SimulatedTurntable turntable(&*museum);
    ScanSettings settings;
    settings.camera = data_sheet_lens(camera.width_px(), camera.height_px(), 70.0 * std::numbers::pi / 180.0);
    settings.with_wall = false;
    settings.with_seams = false;
    const auto outcome = run_calibration(museum->installation(), settings, {screen, camera, turntable}, folder_ / "day",
                                         "2026-01-01T00-00-00Z", SteadyClock(), {}, {});
    std::filesystem::remove_all(folder_ / "day");
    if (outcome) {
      const MuseumScore score = score_of(*museum, outcome->calibration);
      RecordProperty("p95_px", std::to_string(score.p95_px));
      EXPECT_LE(score.p95_px, 0.6) << lux;
      EXPECT_LT(static_cast<double>(score.missing), 0.05 * static_cast<double>(score.lit)) << lux;
    } else {
      EXPECT_THAT(outcome.error().message(), ::testing::HasSubstr("darken the room")) << lux;
    }
  }
}

TEST_F(CalibrationOfLight, equalises_brightness_and_colour_of_the_projectors) {
  const auto preset = simulated::make_preset("cylinder126", 5, two_small_projectors());
  ASSERT_TRUE(preset.has_value());
  auto museum = simulated::SimulatedMuseum::make(preset->installation, preset->truth);
  ASSERT_TRUE(museum.has_value());
  SimulatedPatternScreen screen(&*museum);
  SimulatedScanCamera camera(&*museum, PhotographColour::kGrey);
  SimulatedScanCamera colour_camera(&*museum, PhotographColour::kColour);
  simulated::SimulatedTurntable turntable(&*museum);
  ScanSettings settings;
  settings.camera = data_sheet_lens(camera.width_px(), camera.height_px(), 70.0 * std::numbers::pi / 180.0);
  const auto outcome = run_calibration(museum->installation(), settings, {screen, camera, turntable, &colour_camera},
                                       folder_, "2026-01-01T00-00-00Z", SteadyClock(), {}, {});
  ASSERT_TRUE(outcome.has_value()) << outcome.error().message();
  ASSERT_TRUE(outcome->light.has_value()) << ::testing::PrintToString(outcome->calibration.remarks);
  RecordProperty("response_rms", std::to_string(response_rms(museum->truth(), *outcome->light)));
  EXPECT_LE(response_rms(museum->truth(), *outcome->light), 0.01);
  const SeamScore before = seam_score(museum->truth(), *outcome->light, false);
  const SeamScore after = seam_score(museum->truth(), *outcome->light, true);
  EXPECT_LT(after.delta_e_p95, before.delta_e_p95);
  // A pixel is a hundredth of these pictures, so an error of a map causes a weight error of the same size.
  EXPECT_LE(after.mask_sum_error, 0.02);

  const auto written = calibration::read_colours(calibration::calibration_folder(folder_, outcome->calibration.date));
  ASSERT_TRUE(written.has_value()) << written.error().message();
  ASSERT_EQ(written->size(), 2u);
  EXPECT_EQ(written->front().name, outcome->calibration.projectors.front().name);
  EXPECT_EQ(written->front().mask.width(), 160);
  const auto page = read_text_file(outcome->report, std::size_t{16} << 20);
  ASSERT_TRUE(page.has_value());
  EXPECT_THAT(*page, ::testing::HasSubstr("data:image/jpeg")) << ::testing::PrintToString(outcome->calibration.remarks);
  EXPECT_TRUE(
      std::filesystem::exists(calibration::calibration_folder(folder_, outcome->calibration.date) / "light.json"));

  // Later the projectors' light cannot be measured: masks for the new maps are computed from the previous light.
  WithoutColours without(&screen);
  settings.with_wall = false;
  settings.with_seams = false;
  const auto again = run_calibration(museum->installation(), settings, {without, camera, turntable, &colour_camera},
                                     folder_, "2026-01-02T00-00-00Z", SteadyClock(), {}, {});
  ASSERT_TRUE(again.has_value()) << again.error().message();
  EXPECT_FALSE(again->light.has_value());
  EXPECT_THAT(again->calibration.remarks,
              ::testing::Contains(::testing::HasSubstr("brightness and colours are those of 2026-01-01T00-00-00Z: ")));
  const auto kept = calibration::read_colours(calibration::calibration_folder(folder_, again->calibration.date));
  ASSERT_TRUE(kept.has_value()) << kept.error().message();
  ASSERT_EQ(kept->size(), 2u);
  for (std::size_t p = 0; p < 2; ++p) {
    double worst = 0.0;
    double sum = 0.0;
    const auto old_mask = (*written)[p].mask.data();
    const auto new_mask = (*kept)[p].mask.data();
    ASSERT_EQ(old_mask.size(), new_mask.size());
    for (std::size_t i = 0; i < old_mask.size(); ++i) {
      worst = std::max(worst, std::abs(static_cast<double>(old_mask[i]) - static_cast<double>(new_mask[i])));
      sum += static_cast<double>(new_mask[i]);
    }
    EXPECT_GT(sum, 0.0);
    EXPECT_LT(worst, 0.05);
    EXPECT_EQ((*written)[p].colour.response.has_value(), (*kept)[p].colour.response.has_value());
  }
  EXPECT_TRUE(
      std::filesystem::exists(calibration::calibration_folder(folder_, again->calibration.date) / "light.json"));
}

INSTANTIATE_TEST_SUITE_P(rooms, CalibrationRun, ::testing::Values("cylinder126", "plane"));

}  // namespace
}  // namespace cyclorama::scan
