// SPDX-License-Identifier: Apache-2.0
// The contract of Camera, tested for each kind: file, simulated, and V4L2 on the fake device with both kinds of memory.
#include "drivers/camera/camera.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <vector>

#include "common/image/png.h"
#include "drivers/camera/file/file_camera.h"
#include "drivers/camera/v4l2/v4l2_camera.h"
#include "drivers/simulated/camera/simulated_camera.h"
#include "tests/doubles/fake_clock.h"
#include "tests/doubles/fake_video/fake_video.h"

namespace cyclorama::camera {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Factory for cameras of one kind, at 30 pictures per second.
class Place {
 public:
  virtual ~Place() = default;
  virtual Result<std::unique_ptr<Camera>> open() = 0;
  FakeClock clock;
};

class FilePlace final : public Place {
 public:
  FilePlace() {
    std::filesystem::create_directories(folder_);
    CHECK(write_png(folder_ / "a.png", RgbImage(64, 48, 50)).has_value());
  }
  ~FilePlace() override { std::filesystem::remove_all(folder_); }
  Result<std::unique_ptr<Camera>> open() override { return FileCamera::open(folder_, {30.0, true}, clock); }

 private:
  std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / ("camera-contract-" + std::to_string(::getpid()));
};

class SimulatedPlace final : public Place {
 public:
  Result<std::unique_ptr<Camera>> open() override {
    simulated::Simulation simulation;
    simulation.lens = Pinhole::from_field_of_view(64, 48, 1.0);
    return std::unique_ptr<Camera>(std::make_unique<simulated::SimulatedCamera>(simulation, clock));
  }
};

class V4l2Place final : public Place {
 public:
  explicit V4l2Place(BufferMemory memory) { options_.memory = memory; }
  Result<std::unique_ptr<Camera>> open() override { return V4l2Camera::open("", options_, clock); }

 private:
  V4l2CameraOptions options_;
  FakeVideo video_{{usb_camera()}, &clock};
};

using MakePlace = std::unique_ptr<Place> (*)();

class CameraContract : public testing::TestWithParam<MakePlace> {
 protected:
  CameraContract() : place_(GetParam()()) {
    auto camera = place_->open();
    EXPECT_TRUE(camera.has_value()) << camera.error().message();
    camera_ = *std::move(camera);
  }
  Result<std::shared_ptr<const CameraFrame>> next() { return camera_->next_frame(place_->clock.now() + seconds(2)); }

  std::unique_ptr<Place> place_;
  std::unique_ptr<Camera> camera_;
};

TEST_P(CameraContract, has_a_permanent_id) {
  EXPECT_FALSE(camera_->id().empty());
  const std::string id = camera_->id();
  ASSERT_TRUE(camera_->start().has_value());
  EXPECT_EQ(camera_->id(), id);
  camera_.reset();
  auto again = place_->open();
  ASSERT_TRUE(again.has_value());
  EXPECT_EQ((*again)->id(), id);
}

TEST_P(CameraContract, delivers_nothing_before_start_and_after_stop) {
  EXPECT_EQ(next().error().code(), ErrorCode::kUnavailable);
  camera_->stop();
  ASSERT_TRUE(camera_->start().has_value());
  EXPECT_TRUE(next().has_value());
  camera_->stop();
  camera_->stop();
  EXPECT_EQ(next().error().code(), ErrorCode::kUnavailable);
  ASSERT_TRUE(camera_->start().has_value());
  EXPECT_TRUE(next().has_value());
}

TEST_P(CameraContract, numbers_its_pictures_and_states_when_each_was_taken) {
  ASSERT_TRUE(camera_->start().has_value());
  std::shared_ptr<const CameraFrame> last;
  for (int i = 0; i < 10; ++i) {
    const auto frame = next();
    ASSERT_TRUE(frame.has_value()) << frame.error().message();
    EXPECT_FALSE((*frame)->pixels.empty());
    EXPECT_LE((*frame)->captured_at, place_->clock.now());
    EXPECT_LT(place_->clock.now() - (*frame)->captured_at, milliseconds(50));
    if (last) {
      EXPECT_EQ((*frame)->sequence, last->sequence + 1);
      EXPECT_NEAR(to_milliseconds((*frame)->captured_at - last->captured_at), 1000.0 / 30.0, 0.1);
      EXPECT_EQ((*frame)->pixels.width(), last->pixels.width());
    }
    last = *frame;
  }
}

TEST_P(CameraContract, gives_a_late_caller_the_newest_picture_and_counts_the_gap) {
  ASSERT_TRUE(camera_->start().has_value());
  const auto first = next();
  ASSERT_TRUE(first.has_value());
  place_->clock.advance(milliseconds(100));
  const auto late = next();
  ASSERT_TRUE(late.has_value());
  EXPECT_EQ((*late)->sequence, (*first)->sequence + 3);
  EXPECT_LT(place_->clock.now() - (*late)->captured_at, milliseconds(50));
}

TEST_P(CameraContract, never_returns_a_stale_picture_to_a_late_caller) {
  ASSERT_TRUE(camera_->start().has_value());
  ASSERT_TRUE(next().has_value());
  for (const int pause_ms : {150, 400, 3000}) {
    place_->clock.advance(milliseconds(pause_ms));
    const auto late = next();
    ASSERT_TRUE(late.has_value());
    EXPECT_LT(place_->clock.now() - (*late)->captured_at, milliseconds(50)) << pause_ms;
  }
}

TEST_P(CameraContract, returns_a_ready_picture_although_the_deadline_is_over) {
  ASSERT_TRUE(camera_->start().has_value());
  ASSERT_TRUE(next().has_value());
  place_->clock.advance(milliseconds(50));
  EXPECT_TRUE(camera_->next_frame(place_->clock.now() - seconds(1)).has_value());
}

TEST_P(CameraContract, times_out_at_the_deadline_and_continues) {
  ASSERT_TRUE(camera_->start().has_value());
  ASSERT_TRUE(next().has_value());
  const TimePoint deadline = place_->clock.now() + milliseconds(5);
  const auto none = camera_->next_frame(deadline);
  ASSERT_FALSE(none.has_value());
  EXPECT_EQ(none.error().code(), ErrorCode::kTimedOut);
  EXPECT_EQ(place_->clock.now(), deadline);
  EXPECT_TRUE(next().has_value());
}

TEST_P(CameraContract, never_changes_a_frame_that_the_caller_holds) {
  ASSERT_TRUE(camera_->start().has_value());
  std::vector<std::shared_ptr<const CameraFrame>> held;
  for (int i = 0; i < 12; ++i) held.push_back(*next());
  const GreyImage copy = held.front()->pixels;
  ASSERT_TRUE(next().has_value());
  camera_.reset();
  EXPECT_EQ(held.front()->pixels, copy);
}

template <typename Kind, auto... Arguments>
std::unique_ptr<Place> make_place() {
  return std::make_unique<Kind>(Arguments...);
}
std::string name_of_kind(const testing::TestParamInfo<MakePlace>& kind) {
  constexpr std::array kNames{"file", "simulated", "v4l2", "v4l2_dma_buf"};
  return kNames.at(kind.index);
}
constexpr MakePlace kFile = make_place<FilePlace>;
constexpr MakePlace kSimulated = make_place<SimulatedPlace>;
constexpr MakePlace kMapped = make_place<V4l2Place, BufferMemory::kMapped>;
constexpr MakePlace kDmaBuf = make_place<V4l2Place, BufferMemory::kDmaBuf>;
INSTANTIATE_TEST_SUITE_P(EveryKind, CameraContract, testing::Values(kFile, kSimulated, kMapped, kDmaBuf), name_of_kind);

}  // namespace
}  // namespace cyclorama::camera
