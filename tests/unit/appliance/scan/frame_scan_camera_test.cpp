// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/frame_scan_camera.h"

#include <gmock/gmock.h>

#include <vector>

#include "tests/doubles/fake_clock.h"

namespace cyclorama::scan {
namespace {

constexpr Duration kPeriod = std::chrono::milliseconds(33);

/// A camera with one frame per period of a simulated clock; a frame's brightness is proportional to its exposure.
class SteadyCamera final : public camera::Camera {
 public:
  SteadyCamera(FakeClock* clock, double exposure_s, bool* is_unplugged)
      : clock_(clock), exposure_s_(exposure_s), is_unplugged_(is_unplugged) {}
  [[nodiscard]] const std::string& id() const override { return id_; }
  Status start() override { return Done{}; }
  Result<std::shared_ptr<const camera::CameraFrame>> next_frame(TimePoint deadline) override {
    if (*is_unplugged_) return Error(ErrorCode::kUnavailable, "unplugged");
    // The frame that is delivered now was exposed one period ago, because of the driver's queue.
    const TimePoint captured_at = clock_->now() - kPeriod;
    clock_->wait_until(std::min(deadline, clock_->now() + kPeriod));
    auto frame = std::make_shared<camera::CameraFrame>();
    frame->pixels = GreyImage(8, 6, static_cast<std::uint8_t>(1000.0 * exposure_s_));
    frame->captured_at = captured_at;
    frame->exposure =
        holds_exposure_
            ? std::chrono::duration_cast<Duration>(std::chrono::duration<double>(std::min(exposure_s_, kMaxExposure_s)))
            : Duration::zero();
    captured_.push_back(captured_at);
    return std::shared_ptr<const camera::CameraFrame>(std::move(frame));
  }
  void stop() override {}
  static inline std::vector<TimePoint> captured_;
  static inline bool holds_exposure_ = true;
  static constexpr double kMaxExposure_s = 0.08;

 private:
  FakeClock* clock_;
  double exposure_s_;
  bool* is_unplugged_;
  std::string id_ = "steady";
};

TEST(FrameScanCamera, returns_a_frame_exposed_after_the_request_with_the_requested_exposure) {
  FakeClock clock;
  bool is_unplugged = false;
  std::vector<double> opened;
  const FrameScanCamera::Opener opener = [&](double exposure_s) -> Result<std::unique_ptr<camera::Camera>> {
    opened.push_back(exposure_s);
    return std::unique_ptr<camera::Camera>(std::make_unique<SteadyCamera>(&clock, exposure_s, &is_unplugged));
  };
  auto camera = FrameScanCamera::open(opener, 0.05, clock);
  ASSERT_TRUE(camera.has_value()) << camera.error().message();
  EXPECT_EQ((*camera)->width_px(), 8);
  EXPECT_EQ((*camera)->height_px(), 6);
  EXPECT_EQ((*camera)->id(), "steady");
  EXPECT_FALSE((*camera)->has_colour());
  for (const double exposure : {0.05, 0.05, 0.1, 0.1}) {
    const TimePoint asked_at = clock.now();
    const auto photograph = (*camera)->photograph(exposure);
    ASSERT_TRUE(photograph.has_value()) << photograph.error().message();
    EXPECT_GE(SteadyCamera::captured_.back(), asked_at);
    EXPECT_NEAR((*camera)->exposed_s(exposure), std::min(exposure, SteadyCamera::kMaxExposure_s), 1e-9)
        << "not as asked";
    EXPECT_NEAR(static_cast<double>(photograph->at(3, 3)[2]), exposure * 1000.0 / 255.0, 1e-6);
  }
  EXPECT_EQ(opened, (std::vector<double>{0.05, 0.1})) << "opened again only for another exposure";
  EXPECT_EQ((*camera)->photograph(-1.0).error().code(), ErrorCode::kInvalidArgument);
  is_unplugged = true;
  EXPECT_EQ((*camera)->photograph(0.1).error().code(), ErrorCode::kUnavailable);
  is_unplugged = false;  // The camera is back, and the scan continues.
  EXPECT_TRUE((*camera)->photograph(0.1).has_value());
  SteadyCamera::holds_exposure_ = false;
  const auto automatic = (*camera)->photograph(0.1);
  ASSERT_FALSE(automatic.has_value());
  EXPECT_THAT(automatic.error().message(), ::testing::HasSubstr("exposure can be set by hand"));
}

/// A camera with colour.
class ColourCamera final : public camera::Camera {
 public:
  explicit ColourCamera(FakeClock* clock) : clock_(clock) {}
  [[nodiscard]] const std::string& id() const override { return id_; }
  Status start() override { return Done{}; }
  Result<std::shared_ptr<const camera::CameraFrame>> next_frame(TimePoint) override {
    auto frame = std::make_shared<camera::CameraFrame>();
    frame->captured_at = clock_->now();
    frame->exposure = kPeriod;
    clock_->wait_until(clock_->now() + kPeriod);
    frame->pixels = GreyImage(4, 2, 100);
    frame->colour = RgbImage(4, 2, 51);
    frame->colour.at(3, 1)[1] = 255;
    return std::shared_ptr<const camera::CameraFrame>(std::move(frame));
  }
  void stop() override {}

 private:
  FakeClock* clock_;
  std::string id_ = "colour";
};

TEST(FrameScanCamera, returns_colours_if_the_camera_has_them) {
  FakeClock clock;
  const auto camera = FrameScanCamera::open(
      [&](double) -> Result<std::unique_ptr<camera::Camera>> {
        return std::unique_ptr<camera::Camera>(std::make_unique<ColourCamera>(&clock));
      },
      0.05, clock);
  ASSERT_TRUE(camera.has_value()) << camera.error().message();
  EXPECT_TRUE((*camera)->has_colour());
  const auto photograph = (*camera)->photograph(0.05);
  ASSERT_TRUE(photograph.has_value());
  EXPECT_FLOAT_EQ(photograph->at(3, 1)[0], 0.2f);
  EXPECT_FLOAT_EQ(photograph->at(3, 1)[1], 1.0f);
}

}  // namespace
}  // namespace cyclorama::scan
