// SPDX-License-Identifier: Apache-2.0
// A whole display whose calibration is replaced while it shows.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "appliance/calibration/calibration_file.h"
#include "appliance/display/display.h"
#include "common/base/file.h"
#include "drivers/output/shared_picture.h"
#include "tests/data_sets/demo_room.h"
#include "tests/data_sets/exact_calibration.h"
#include "tests/data_sets/jpeg_tiles.h"
#include "tests/doubles/fake_tour.h"

namespace cyclorama::display {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class DisplayCalibrationTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string folder = ::testing::TempDir() + "/calibrated.XXXXXX";
    ASSERT_NE(::mkdtemp(folder.data()), nullptr);
    folder_ = folder;
    std::filesystem::create_directory(folder_ / "run");
    tour_ = FakeTour::start();
  }
  void TearDown() override {
    if (serving_.joinable()) serving_.request_stop();
    if (serving_.joinable()) serving_.join();
    display_.reset();
    std::filesystem::remove_all(folder_);
  }
  void start() {
    DisplayOptions options;
    options.installation = room_;
    options.tour = tour_->address();
    options.output.run_dir = folder_ / "run";
    options.width_px = 512;
    options.refresh_hz = 60.0;
    options.attract_times.fade = std::chrono::milliseconds(50);
    options.calibration = folder_;
    auto display = Display::start(std::move(options), clock_);
    ASSERT_TRUE(display) << display.error().message();
    display_ = *std::move(display);
    serving_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) display_->serve(clock_.now() + std::chrono::milliseconds(20));
    });
    ASSERT_TRUE(tour_->wait_for_display());
  }
  /// Shows a dark left and a bright right half; repeats it whenever the display reconnects, as a tour does.
  void show_halves() {
    const Panorama wanted = room_.panorama(512);
    RgbImage halves(wanted.width_px, wanted.height_px, 20);
    for (int y = 0; y < halves.height(); ++y)
      std::fill(halves.at(halves.width() / 2, y), halves.at(halves.width() - 1, y) + 3, std::uint8_t{200});
    tour_->send_all(frame_messages(++frame_, halves, wanted));
  }
  /// Returns the column where the middle projector's picture becomes bright, in its pixels; -1 if it does not.
  int edge() {
    auto reader = output::SharedPictureReader::open(output::shared_picture_path(folder_ / "run", "middle"));
    RgbImage picture;
    if (!reader || !reader->read_newest(&picture)) return -1;
    for (int x = 0; x < picture.width(); ++x) {
      if (picture.at(x, picture.height() / 2)[1] > 110) return x;
    }
    return -1;
  }
  std::string fact(const std::string& name) {
    const wire::ProcessStatus status = display_->inspection().status();
    for (const wire::Fact& fact : status.facts()) {
      if (fact.name() == name) return fact.value();
    }
    return {};
  }
  bool wait_until(const std::function<bool()>& condition) {
    const TimePoint deadline = clock_.now() + std::chrono::seconds(20);
    while (!condition()) {
      if (clock_.now() > deadline) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
  }

  SteadyClock clock_;
  Installation room_ = demo_room_with_pixels_over(4);
  std::filesystem::path folder_;
  std::uint64_t frame_ = 0;
  std::unique_ptr<FakeTour> tour_;
  std::unique_ptr<Display> display_;
  std::jthread serving_;
};

TEST_F(DisplayCalibrationTest, uses_a_new_calibration_ignores_a_bad_one_and_can_return) {
  start();
  EXPECT_THAT(fact("calibration_refused"), HasSubstr("none yet"));
  show_halves();
  ASSERT_TRUE(wait_until([&] { return std::abs(edge() - 80) <= 2; })) << edge();

  // The light lies farther right than assumed, so the middle is shown farther left.
  const double px_per_rad = room_.projectors[1].lens.focal_px;
  ASSERT_TRUE(calibration::save_calibration(folder_, exact_calibration(room_, "2026-01-01T00-00-00Z", 0.1)));
  ASSERT_TRUE(wait_until([&] { return fact("calibration") == "2026-01-01T00-00-00Z"; }));
  EXPECT_EQ(tour_->displays, 1) << "all parts of the picture are there already";
  show_halves();
  const auto is_moved = [&] { return edge() >= 0 && edge() < 80 - static_cast<int>(0.04 * px_per_rad); };
  EXPECT_TRUE(wait_until(is_moved)) << edge();
  EXPECT_EQ(fact("calibration"), "2026-01-01T00-00-00Z");
  EXPECT_EQ(fact("calibration_refused"), "");
  const int moved_to = edge();

  ASSERT_TRUE(write_file_atomically(folder_ / "calibration.json", std::string_view("{\"format\": 7}")));
  EXPECT_TRUE(wait_until([&] { return !fact("calibration_refused").empty(); }));
  EXPECT_THAT(fact("calibration_refused"), HasSubstr("calibration.json"));
  EXPECT_EQ(fact("calibration"), "2026-01-01T00-00-00Z") << "the old one stays";
  EXPECT_EQ(edge(), moved_to);
  show_halves();
  EXPECT_TRUE(wait_until([&] {
    return display_->inspection().status().state().find("The newest calibration is not used") != std::string::npos;
  }));

  ASSERT_TRUE(calibration::save_calibration(folder_, exact_calibration(room_, "2026-01-02T00-00-00Z")));
  ASSERT_TRUE(wait_until([&] { return fact("calibration") == "2026-01-02T00-00-00Z"; }));
  EXPECT_EQ(fact("calibration_refused"), "");
  EXPECT_TRUE(wait_until([&] { return std::abs(edge() - 80) <= 2; })) << "no frame comes: it does not wait for ever";
  ASSERT_TRUE(calibration::restore_calibration(folder_, "2026-01-01T00-00-00Z"));
  EXPECT_TRUE(wait_until([&] { return edge() == moved_to; }));
}

TEST_F(DisplayCalibrationTest, starts_with_the_existing_calibration) {
  ASSERT_TRUE(calibration::save_calibration(folder_, exact_calibration(room_, "2026-01-01T00-00-00Z", 0.1)));
  start();
  EXPECT_THAT(fact("calibration"), StartsWith("2026-01-01"));
  show_halves();
  EXPECT_TRUE(wait_until([&] { return edge() >= 0 && edge() < 75; })) << edge();
}

TEST_F(DisplayCalibrationTest, starts_with_the_installation_if_the_calibration_is_broken) {
  ASSERT_TRUE(write_file_atomically(folder_ / "calibration.json", std::string_view("no JSON")));
  start();
  EXPECT_THAT(fact("calibration_refused"), HasSubstr("no JSON"));
  show_halves();
  EXPECT_TRUE(wait_until([&] { return std::abs(edge() - 80) <= 2; })) << edge();
}

}  // namespace
}  // namespace cyclorama::display
