// SPDX-License-Identifier: Apache-2.0
// A calibration with a video camera (V4L2): its exposure steps, 8 bits and YUYV. Only the driver is simulated; it
// delivers photographs of the simulated museum.
#include <gmock/gmock.h>
#include <unistd.h>

#include <numbers>

#include "appliance/calibration/calibration_file.h"
#include "appliance/scan/calibration_run.h"
#include "appliance/scan/frame_scan_camera.h"
#include "appliance/scan/simulated_devices.h"
#include "drivers/camera/v4l2/v4l2_camera.h"
#include "drivers/simulated/museum/presets.h"
#include "drivers/simulated/turntable/simulated_turntable.h"
#include "tests/data_sets/photometry_museum.h"
#include "tests/doubles/fake_video/fake_video.h"
#include "tests/support/museum_score.h"

namespace cyclorama::scan {
namespace {

/// Counts the pictures shown, so that the camera can detect a change.
class CountingScreen final : public PatternScreen {
 public:
  explicit CountingScreen(simulated::SimulatedMuseum* museum) : screen_(museum) {}
  Status show(std::size_t projector, const RgbImage& picture) override {
    ++shown;
    return screen_.show(projector, picture);
  }
  int shown = 0;

 private:
  SimulatedPatternScreen screen_;
};

TEST(VideoCalibration, aligns_the_projectors_with_a_v4l2_camera) {
  simulated::PresetOptions options;
  options.projectors = 2;
  options.projector_width_px = 160;
  options.projector_height_px = 100;
  options.camera_megapixels = 0.1;
  const auto preset = simulated::make_preset("cylinder126", 5, options);
  ASSERT_TRUE(preset.has_value());
  auto museum = simulated::SimulatedMuseum::make(preset->installation, preset->truth);
  ASSERT_TRUE(museum.has_value());
  CountingScreen screen(&*museum);
  simulated::SimulatedTurntable turntable(&*museum);

  // The museum is photographed only after it or the exposure has changed; until then the driver repeats the same
  // picture.
  struct State {
    int shown = -1;
    double angle_rad = 0.0;
    double exposure_s = 0.0;
    bool operator==(const State&) const = default;
  } last;
  RgbImage seen;
  FakeVideoDevice device = usb_camera();
  const int width = museum->camera_width_px() / 2 * 2;
  device.formats = {{V4L2_PIX_FMT_YUYV, {{width, museum->camera_height_px(), {30.0, 10.0, 4.0, 2.0, 1.0}}}}};
  device.controls[V4L2_CID_EXPOSURE_ABSOLUTE] = {1, 10000, 1, 250};
  device.controls[V4L2_CID_AUTO_WHITE_BALANCE] = {0, 1, 1, 1};
  device.sees = [&](double exposure_s) {
    const State now{screen.shown, museum->turntable_angle_rad(), exposure_s};
    if (now == last) return seen;
    last = now;
    const auto photograph = museum->photograph_colour(exposure_s);
    CHECK(photograph.has_value());
    const RgbImage whole = simulated::to_8_bits(*photograph, museum->camera_bits());
    seen = RgbImage(width, whole.height());
    for (int y = 0; y < seen.height(); ++y) std::copy_n(whole.at(0, y), 3 * width, seen.at(0, y));
    return seen;
  };
  FakeClock clock;
  FakeVideo video({device}, &clock);
  const auto opener = [&](double exposure_s) {
    camera::V4l2CameraOptions camera;
    camera.exposure = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(exposure_s));
    camera.gain = camera::GainRule::kHeld;
    camera.preferred = {width, museum->camera_height_px(), std::min(30.0, 0.9 / exposure_s), true};
    return camera::V4l2Camera::open(device.port, camera, clock);
  };
  auto camera = FrameScanCamera::open(opener, 1.0 / 60.0, clock);
  ASSERT_TRUE(camera.has_value()) << camera.error().message();
  ASSERT_TRUE((*camera)->has_colour());

  ScanSettings settings;
  settings.camera = data_sheet_lens((*camera)->width_px(), (*camera)->height_px(), 70.0 * std::numbers::pi / 180.0);
  settings.with_seams = false;
  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) / ("video-" + std::to_string(getpid()));
  const auto outcome = run_calibration(museum->installation(), settings, {screen, **camera, turntable}, folder,
                                       "2026-01-01T00-00-00Z", clock, {}, {});
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
  ASSERT_TRUE(outcome.has_value()) << outcome.error().message();

  const MuseumScore score = museum_score(museum->truth(), [&](std::size_t p, const Eigen::Vector2d& pixel) {
    return outcome->calibration.projectors[p].map.direction_at(pixel);
  });
  RecordProperty("p95_px", std::to_string(score.p95_px));
  EXPECT_GT(score.correspondences, 100u);
  EXPECT_LE(score.mean_px, 0.25);
  EXPECT_LE(score.p95_px, 0.6);
  EXPECT_LE(score.max_px, 1.0);
  ASSERT_TRUE(outcome->light.has_value()) << ::testing::PrintToString(outcome->calibration.remarks);
  RecordProperty("response_rms", std::to_string(response_rms(museum->truth(), *outcome->light)));
  EXPECT_LE(response_rms(museum->truth(), *outcome->light), 0.02);
}

}  // namespace
}  // namespace cyclorama::scan
