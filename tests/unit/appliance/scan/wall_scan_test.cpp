// SPDX-License-Identifier: Apache-2.0
// Faults during a scan, in a very small museum for speed. The accuracy of the scan is tested in calibration_run_test.
#include "appliance/scan/wall_scan.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <numbers>

#include "appliance/scan/light_scan.h"
#include "appliance/scan/simulated_devices.h"
#include "drivers/simulated/museum/presets.h"
#include "drivers/simulated/turntable/simulated_turntable.h"

namespace cyclorama::scan {
namespace {

using ::testing::AnyOf;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// A camera that fails, or before which somebody walks, between two given photographs.
class TroubledCamera final : public ScanCamera {
 public:
  explicit TroubledCamera(ScanCamera* camera) : camera_(camera) {}
  [[nodiscard]] const std::string& id() const override { return camera_->id(); }
  [[nodiscard]] int width_px() const override { return camera_->width_px(); }
  [[nodiscard]] int height_px() const override { return camera_->height_px(); }
  [[nodiscard]] bool has_colour() const override { return camera_->has_colour(); }
  Result<ScanPhotograph> photograph(double exposure_s) override {
    const int number = taken++;
    if (number >= unplugged_from) return Error(ErrorCode::kUnavailable, "camera 'usb-1' is gone; plug it in again");
    if (number == cancel_at) stop.request_stop();
    if (number >= smaller_from) return ScanPhotograph(width_px() / 2, height_px() / 2);
    TRY_ASSIGN(ScanPhotograph photograph, camera_->photograph(exposure_s));
    if (number >= person_from && number < person_until) {
      // A person a third of the picture wide walks from the left to the right.
      const int step = photograph.width() / std::max(1, std::min(person_until, 1000) - person_from);
      const int at = (number - person_from) * std::max(step, 3) % photograph.width();
      for (int y = 0; y < photograph.height(); ++y) {
        for (int x = at; x < std::min(at + photograph.width() / 3, photograph.width()); ++x)
          std::fill_n(photograph.at(x, y), 3, 0.05f);
      }
    }
    return photograph;
  }
  int taken = 0;
  int unplugged_from = 1 << 30;
  int person_from = 1 << 30;
  int person_until = 1 << 30;
  int cancel_at = -1;
  int smaller_from = 1 << 30;
  std::stop_source stop;

 private:
  ScanCamera* camera_;
};

/// A screen with one projector that stays dark; it records what is lit.
class TroubledScreen final : public PatternScreen {
 public:
  TroubledScreen(PatternScreen* screen, std::size_t projectors) : lit(projectors, false), screen_(screen) {}
  Status show(std::size_t projector, const RgbImage& picture) override {
    lit.at(projector) = !picture.empty();
    max_lit = std::max(max_lit, std::count(lit.begin(), lit.end(), true));
    return screen_->show(projector, static_cast<int>(projector) == dark ? RgbImage() : picture);
  }
  int dark = -1;
  std::vector<bool> lit;
  std::ptrdiff_t max_lit = 0;

 private:
  PatternScreen* screen_;
};

class StallingTurntable final : public turntable::Turntable {
 public:
  explicit StallingTurntable(simulated::SimulatedMuseum* museum) : turntable::Turntable({-3.0, 3.0}), museum_(museum) {}
  [[nodiscard]] const std::string& id() const override { return id_; }
  int stalls = 0;
  int homed = 0;

 private:
  Status move_home() override {
    ++homed;
    museum_->turn_to(0.0);
    return Done{};
  }
  Status move_to(double angle_rad) override {
    if (stalls-- > 0) return Error(ErrorCode::kTimedOut, "it did not arrive; free it");
    museum_->turn_to(angle_rad + 1e-3 * turns++);  // The turntable never stops twice at the same angle.
    return Done{};
  }
  int turns = 0;
  Result<double> ask_angle() override { return museum_->turntable_angle_rad(); }
  std::string id_ = "stalling";
  simulated::SimulatedMuseum* museum_;
};

simulated::SimulatedMuseum small_museum() {
  simulated::PresetOptions options;
  options.projectors = 2;
  options.projector_width_px = 64;
  options.projector_height_px = 40;
  options.camera_megapixels = 0.02;
  auto preset = simulated::make_preset("cylinder126", 1, options);
  return *simulated::SimulatedMuseum::make(preset->installation, preset->truth);
}

class WallScanTest : public ::testing::Test {
 protected:
  WallScanTest()
      : folder_(std::filesystem::path(::testing::TempDir()) / ("wall-scan-" + std::to_string(getpid()))),
        museum_(small_museum()),
        real_screen_(&museum_),
        real_camera_(&museum_, PhotographColour::kGrey),
        screen_(&real_screen_, 2),
        camera_(&real_camera_),
        turntable_(&museum_) {
    settings_.camera = data_sheet_lens(camera_.width_px(), camera_.height_px(), 70.0 * std::numbers::pi / 180.0);
    settings_.view.decode.min_patch_px = 10;
  }
  ~WallScanTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  Result<WallScan> scan() {
    told_.clear();
    return scan_wall(
        museum_.installation(), settings_, {screen_, camera_, turntable_}, folder_,
        [&](const ScanProgress& progress) { told_.push_back(progress.fraction); }, camera_.stop.get_token());
  }
  [[nodiscard]] static std::size_t places_of(const WallScan& scan) {
    std::size_t correspondences = 0;
    for (const solve::TurntableDirection& d : scan.measurements.directions) correspondences += d.correspondences.size();
    return correspondences;
  }

  std::filesystem::path folder_;
  simulated::SimulatedMuseum museum_;
  SimulatedPatternScreen real_screen_;
  SimulatedScanCamera real_camera_;
  TroubledScreen screen_;
  TroubledCamera camera_;
  StallingTurntable turntable_;
  ScanSettings settings_;
  std::vector<double> told_;
};

TEST_F(WallScanTest, lights_one_projector_at_a_time_and_leaves_the_wall_dark) {
  const auto result = scan();
  ASSERT_TRUE(result.has_value()) << result.error().message();
  EXPECT_EQ(screen_.max_lit, 1);
  EXPECT_THAT(screen_.lit, Each(false));
  EXPECT_TRUE(result->measurements.validate().has_value());
  EXPECT_GE(result->measurements.directions.size(), 2u);
  EXPECT_GT(places_of(*result), 5000u);
  EXPECT_EQ(result->pictures, camera_.taken);
  EXPECT_EQ(result->retries, 0);
  EXPECT_TRUE(std::is_sorted(told_.begin(), told_.end()));
  EXPECT_GE(told_.front(), 0.0);
  EXPECT_LE(told_.back(), 1.0);
  EXPECT_GT(told_.back(), 0.95);
}

TEST_F(WallScanTest, resumes_after_the_camera_was_unplugged_without_repeating_a_view) {
  const auto whole = scan();
  ASSERT_TRUE(whole.has_value());
  const int all = camera_.taken;
  camera_.taken = 0;
  camera_.unplugged_from = all / 2;
  const auto broken = scan();
  ASSERT_FALSE(broken.has_value());
  EXPECT_EQ(broken.error().code(), ErrorCode::kUnavailable);
  EXPECT_THAT(broken.error().message(), HasSubstr("plug it in"));
  EXPECT_THAT(screen_.lit, Each(false));
  camera_.unplugged_from = 1 << 30;
  camera_.taken = 0;
  settings_.resume = true;
  const auto resumed = scan();
  ASSERT_TRUE(resumed.has_value()) << resumed.error().message();
  EXPECT_LT(camera_.taken, 3 * all / 4);
  EXPECT_EQ(resumed->measurements.directions.size(), whole->measurements.directions.size());
  EXPECT_NEAR(static_cast<double>(places_of(*resumed)), static_cast<double>(places_of(*whole)),
              0.05 * static_cast<double>(places_of(*whole)));
  // Nothing is left to measure.
  camera_.taken = 0;
  ASSERT_TRUE(scan().has_value());
  EXPECT_EQ(camera_.taken, 0);
}

TEST_F(WallScanTest, ends_within_one_picture_when_cancelled) {
  camera_.cancel_at = 20;
  const auto cancelled_scan = scan();
  ASSERT_FALSE(cancelled_scan.has_value());
  EXPECT_THAT(cancelled_scan.error().message(), HasSubstr("cancelled"));
  EXPECT_EQ(camera_.taken, 21);
  EXPECT_THAT(screen_.lit, Each(false));
}

TEST_F(WallScanTest, repeats_a_measurement_through_which_somebody_walked) {
  camera_.person_from = 12;
  camera_.person_until = 24;
  const auto result = scan();
  ASSERT_TRUE(result.has_value()) << result.error().message();
  EXPECT_EQ(result->retries, 1);
  EXPECT_THAT(result->remarks, IsEmpty());
}

TEST_F(WallScanTest, reports_a_person_who_does_not_go_away) {
  camera_.person_from = 12;
  camera_.person_until = 100000;
  const auto result = scan();
  if (!result) {
    EXPECT_THAT(result.error().message(), AnyOf(HasSubstr("; "), HasSubstr("open the iris")));
    return;
  }
  EXPECT_GE(result->retries, 2);
  ASSERT_THAT(result->remarks, Not(IsEmpty()));
  EXPECT_THAT(result->remarks.front(), HasSubstr("keep people away"));
}

TEST_F(WallScanTest, reports_a_projector_that_stays_dark_and_resumes_when_it_is_on) {
  screen_.dark = 1;
  const auto dark = scan();
  ASSERT_FALSE(dark.has_value());
  EXPECT_EQ(dark.error().code(), ErrorCode::kUnavailable);
  EXPECT_THAT(dark.error().message(), HasSubstr("'projector 2'"));
  EXPECT_THAT(dark.error().message(), HasSubstr("switch it on"));
  screen_.dark = -1;
  settings_.resume = true;
  const auto lit = scan();
  ASSERT_TRUE(lit.has_value()) << lit.error().message();
}

TEST_F(WallScanTest, takes_all_views_of_a_direction_from_one_stop_of_the_turntable) {
  const auto whole = scan();
  ASSERT_TRUE(whole.has_value()) << whole.error().message();
  // The camera is unplugged in each part of a scan in turn.
  for (int part = 1; part < 8; ++part) {
    settings_.resume = false;
    camera_.unplugged_from = camera_.taken + part * whole->pictures / 8;
    ASSERT_FALSE(scan().has_value()) << part;
    camera_.unplugged_from = 1 << 30;
    settings_.resume = true;
    const auto rest = scan();
    ASSERT_TRUE(rest.has_value()) << rest.error().message();
    ASSERT_EQ(rest->views.size(), whole->views.size());
    for (const ScanView& one : rest->views) {
      for (const ScanView& other : rest->views) {
        if (one.direction != other.direction) continue;
        EXPECT_EQ(one.angle_rad, other.angle_rad) << part;
      }
    }
  }
}

TEST_F(WallScanTest, refuses_photographs_that_have_become_smaller) {
  const auto whole = scan();
  ASSERT_TRUE(whole.has_value()) << whole.error().message();
  camera_.smaller_from = camera_.taken;
  const auto light = scan_light(museum_.installation(), whole->views, settings_.view.exposure,
                                {screen_, camera_, turntable_}, nullptr, camera_.stop.get_token());
  ASSERT_FALSE(light.has_value());
  EXPECT_EQ(light.error().code(), ErrorCode::kBadData);
  EXPECT_THAT(light.error().message(), HasSubstr("instead of"));
  EXPECT_THAT(screen_.lit, Each(false));
}

TEST_F(WallScanTest, homes_a_turntable_that_stalled_once_and_gives_up_if_it_always_stalls) {
  turntable_.stalls = 1;
  ASSERT_TRUE(scan().has_value());
  EXPECT_EQ(turntable_.homed, 2);
  turntable_.stalls = 1000;
  const auto stuck = scan();
  ASSERT_FALSE(stuck.has_value());
  EXPECT_EQ(stuck.error().code(), ErrorCode::kTimedOut);
  EXPECT_THAT(stuck.error().message(), HasSubstr("free it"));
}

TEST_F(WallScanTest, refuses_to_resume_with_other_patterns) {
  ASSERT_TRUE(scan().has_value());
  settings_.resume = true;
  settings_.view.finest_bit = 2;
  const auto other = scan();
  ASSERT_FALSE(other.has_value());
  EXPECT_EQ(other.error().code(), ErrorCode::kBadData);
}

}  // namespace
}  // namespace cyclorama::scan
