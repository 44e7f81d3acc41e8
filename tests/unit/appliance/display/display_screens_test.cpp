// SPDX-License-Identifier: Apache-2.0
// The whole display before walls of every shape: what it makes of a tour's JPEG tiles lights the simulated room's wall,
// which knows nothing of warps; there the eye must see what lies in each direction, turned or not.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "appliance/display/display.h"
#include "common/geometry/guard_band.h"
#include "common/image/colour.h"
#include "drivers/output/shared_picture.h"
#include "drivers/simulated_room/room_picture.h"
#include "tests/doubles/demo_room.h"
#include "tests/doubles/fake_tour.h"
#include "tests/doubles/jpeg_tiles.h"

namespace cyclorama {
namespace {

/// Smooth, and different everywhere; linear light.
std::array<double, 3> light_from(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d d = direction.normalized();
  return {0.5 + 0.3 * std::sin(4.0 * d.x()), 0.5 + 0.3 * std::cos(5.0 * d.y()), 0.5 + 0.3 * std::sin(3.0 * d.z())};
}

RgbImage picture_of(const PictureShape& shape) {
  RgbImage picture(width_px(shape), height_px(shape));
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const auto light = light_from(direction_at(shape, {x + 0.5, y + 0.5}).value_or(Eigen::Vector3d::UnitX()));
      for (std::size_t c = 0; c < 3; ++c) picture.at(x, y)[c] = linear_to_srgb8(static_cast<float>(light[c]));
    }
  }
  return picture;
}

/// Of the light at many places of the wall: the mean and the largest distance from what is to be seen there.
struct Off {
  double mean = 0.0;
  double most = 0.0;
};

class ScreenDisplaying : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    std::string folder = ::testing::TempDir() + "/screens.XXXXXX";
    ASSERT_NE(::mkdtemp(folder.data()), nullptr);
    run_dir_ = folder;
    const auto room = read_installation(demo_installation_path().parent_path() / GetParam());
    ASSERT_TRUE(room) << room.error().message();
    room_ = *room;
    DisplayOptions options;
    options.installation = room_;
    options.tour = tour_->address();
    options.output.run_dir = run_dir_;
    options.width_px = 768;
    options.refresh_hz = 60.0;
    options.attract_times = {std::chrono::minutes(10), std::chrono::milliseconds(100)};
    auto display = Display::start(std::move(options), clock_);
    ASSERT_TRUE(display) << display.error().message();
    display_ = *std::move(display);
    serving_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) display_->serve(clock_.now() + std::chrono::milliseconds(20));
    });
    ASSERT_TRUE(tour_->wait_for_display());
  }
  void TearDown() override {
    if (serving_.joinable()) serving_.request_stop();
    if (serving_.joinable()) serving_.join();
    display_.reset();
    std::filesystem::remove_all(run_dir_);
  }
  std::vector<RgbImage> heads() {
    std::vector<RgbImage> pictures;
    for (const InstalledProjector& projector : room_.projectors) {
      RgbImage& picture = pictures.emplace_back(projector.lens.width_px, projector.lens.height_px);
      auto reader = SharedPictureReader::open(shared_picture_path(run_dir_, projector.name));
      EXPECT_TRUE(reader && reader->read_newest(&picture));
    }
    return pictures;
  }
  Off seen(const RoomPicture& photographer, double turn_rad) {
    const std::vector<RgbImage> lit = heads();
    const Eigen::AngleAxisd turned_right(-turn_rad, Eigen::Vector3d::UnitY());
    Off off;
    int count = 0;
    for (const WallPatch& patch : patches(room_.wall, 4000)) {
      const auto radiance = photographer.radiance_at(patch.middle, lit);
      const auto expected = light_from(turned_right * (patch.middle.xyz - room_.sweet_spot.xyz));
      for (std::size_t c = 0; c < 3; ++c) {
        const double distance = std::abs(static_cast<double>(radiance[c]) / 0.9 - expected[c]);
        off.mean += distance;
        off.most = std::max(off.most, distance);
        ++count;
      }
    }
    off.mean /= count;
    return off;
  }

  SteadyClock clock_;
  std::filesystem::path run_dir_;
  Installation room_;
  std::unique_ptr<FakeTour> tour_ = FakeTour::start();
  std::unique_ptr<Display> display_;
  std::jthread serving_;
};

TEST_P(ScreenDisplaying, the_wall_shows_what_the_eye_is_to_see_at_every_heading) {
  const auto asked = from_wire(tour_->hello.wanted());
  ASSERT_TRUE(asked) << asked.error().message();
  EXPECT_EQ(*asked, room_.picture(768));
  const PictureShape guarded = with_guard_band(*asked, 0.15);
  tour_->send_all(frame_messages(1, picture_of(guarded), guarded, 1.0));
  ASSERT_TRUE(tour_->wait_for_reports(1, 0));
  const RoomPicture photographer(room_, RoomEye::behind_visitor(room_, 16, 9));
  for (const double turn : {0.0, 0.12, -0.15}) {
    tour_->send_heading(1.0 + turn, 0);
    // The attract picture fades out, and headings take their time.
    Off off{1.0, 1.0};
    const TimePoint deadline = clock_.now() + std::chrono::seconds(60);
    while (off.mean >= 0.004 && clock_.now() < deadline) off = seen(photographer, turn);
    std::printf("%s, turned by %.2f: light off by %.4f on average, %.4f at most\n", GetParam(), turn, off.mean,
                off.most);
    EXPECT_LT(off.mean, 0.004);  // A code value is 0.0067 there.
    EXPECT_LT(off.most, 0.05);
  }
}

INSTANTIATE_TEST_SUITE_P(Demo, ScreenDisplaying,
                         ::testing::Values("installation.toml", "plane.toml", "corner.toml", "dome.toml", "mesh.toml"),
                         [](const auto& tested) {
                           const std::string name = tested.param;
                           return name.substr(0, name.find('.'));
                         });

}  // namespace
}  // namespace cyclorama
