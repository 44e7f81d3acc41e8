// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/file/file_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <vector>

#include "common/base/file.h"
#include "common/image/png.h"
#include "tests/data_sets/shared_data.h"
#include "tests/doubles/fake_clock.h"

namespace cyclorama::camera {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

/// Provides a separate folder for each test.
class FileCameraTest : public testing::Test {
 protected:
  FileCameraTest() {
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("cyclorama-" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + "-" +
               std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~FileCameraTest() override { std::filesystem::remove_all(folder_); }

  /// Writes a grey photo whose level identifies it.
  void put_photo(const std::string& name, std::uint8_t grey, int width = 4, int height = 3) const {
    ASSERT_TRUE(write_png(folder_ / name, RgbImage(width, height, grey)).has_value());
  }
  void put_file(const std::string& name, std::string_view bytes) const {
    ASSERT_TRUE(write_file_atomically(folder_ / name, bytes).has_value());
  }
  [[nodiscard]] std::unique_ptr<Camera> started(const std::filesystem::path& path, FileCameraOptions options) const {
    auto camera = FileCamera::open(path, options, clock_);
    EXPECT_TRUE(camera.has_value()) << camera.error().message();
    if (!camera) return nullptr;
    EXPECT_TRUE((*camera)->start().has_value());
    return *std::move(camera);
  }
  [[nodiscard]] Result<std::shared_ptr<const CameraFrame>> next(Camera* camera) const {
    return camera->next_frame(clock_.now() + std::chrono::seconds(10));
  }

  std::filesystem::path folder_;
  FakeClock clock_;
};

TEST_F(FileCameraTest, replays_a_folder_in_the_order_of_names_and_loops) {
  put_photo("b.png", 20);
  put_photo("a.PNG", 10);
  put_photo("c.png", 30);
  put_file("notes.txt", "not a photo");
  const auto camera = started(folder_, {4.0, true});
  const TimePoint start = clock_.now();
  for (const int expected : {10, 20, 30, 10, 20}) {
    const auto frame = next(camera.get());
    ASSERT_TRUE(frame.has_value()) << frame.error().message();
    EXPECT_EQ(*(*frame)->pixels.at(0, 0), expected);
    EXPECT_EQ((*frame)->captured_at, start + milliseconds(250) * static_cast<int>((*frame)->sequence));
  }
  EXPECT_EQ(clock_.now(), start + milliseconds(1000));
}

TEST_F(FileCameraTest, gives_a_late_caller_the_newest_photo_and_counts_the_gap) {
  for (int i = 0; i < 10; ++i) put_photo("p" + std::to_string(i) + ".png", static_cast<std::uint8_t>(10 * i));
  const auto camera = started(folder_, {10.0, true});
  ASSERT_TRUE(next(camera.get()).has_value());
  clock_.advance(milliseconds(730));
  const auto frame = next(camera.get());
  ASSERT_TRUE(frame.has_value());
  EXPECT_EQ((*frame)->sequence, 7U);
  EXPECT_EQ(*(*frame)->pixels.at(0, 0), 70);
}

TEST_F(FileCameraTest, ends_like_an_unplugged_camera_unless_it_loops) {
  put_photo("only.png", 10);
  const auto camera = started(folder_ / "only.png", {10.0, false});
  ASSERT_TRUE(next(camera.get()).has_value());
  for (int again = 0; again < 2; ++again) {
    const auto ended = next(camera.get());
    ASSERT_FALSE(ended.has_value());
    EXPECT_EQ(ended.error().code(), ErrorCode::kUnavailable);
    EXPECT_THAT(ended.error().message(), HasSubstr("has ended"));
  }
}

TEST_F(FileCameraTest, times_out_and_continues) {
  put_photo("only.png", 10);
  const auto camera = started(folder_, {1.0, true});
  ASSERT_TRUE(next(camera.get()).has_value());
  const auto none = camera->next_frame(clock_.now() + milliseconds(100));
  ASSERT_FALSE(none.has_value());
  EXPECT_EQ(none.error().code(), ErrorCode::kTimedOut);
  EXPECT_TRUE(next(camera.get()).has_value());
}

TEST_F(FileCameraTest, must_be_started) {
  put_photo("only.png", 10);
  auto camera = FileCamera::open(folder_, {}, clock_);
  ASSERT_TRUE(camera.has_value());
  EXPECT_FALSE(next(camera->get()).has_value());
  ASSERT_TRUE((*camera)->start().has_value());
  EXPECT_TRUE(next(camera->get()).has_value());
  (*camera)->stop();
  EXPECT_FALSE(next(camera->get()).has_value());
}

TEST_F(FileCameraTest, fails_on_a_damaged_photo_and_names_it) {
  put_photo("a.png", 10);
  put_file("b.png", "\x89PNG and then nothing of the kind");
  const auto camera = started(folder_, {10.0, true});
  ASSERT_TRUE(next(camera.get()).has_value());
  const auto broken = next(camera.get());
  ASSERT_FALSE(broken.has_value());
  EXPECT_EQ(broken.error().code(), ErrorCode::kUnavailable);
  EXPECT_THAT(broken.error().message(), HasSubstr("b.png"));
}

TEST_F(FileCameraTest, names_what_is_wrong_with_a_file) {
  put_file("empty.png", "");
  put_file("text.jpg", "hello");
  put_file("cut.mp4", std::string("\0\0\0\x18"
                                  "ftypmp42\0\0\0\0mp42isom",
                                  24));
  put_file("matroska.mkv", "\x1a\x45\xdf\xa3 and then nothing of the kind");
  const std::pair<const char*, ErrorCode> cases[] = {{"empty.png", ErrorCode::kBadData},
                                                     {"text.jpg", ErrorCode::kBadData},
                                                     {"cut.mp4", ErrorCode::kBadData},
                                                     {"matroska.mkv", ErrorCode::kBadData},
                                                     {"absent.png", ErrorCode::kNotFound}};
  for (const auto& [name, code] : cases) {
    const auto camera = FileCamera::open(folder_ / name, {}, clock_);
    ASSERT_FALSE(camera.has_value()) << name;
    EXPECT_EQ(camera.error().code(), code) << camera.error().message();
    EXPECT_THAT(camera.error().message(), HasSubstr(name));
  }
  std::filesystem::create_directory(folder_ / "nothing");
  EXPECT_EQ(FileCamera::open(folder_ / "nothing", {}, clock_).error().code(), ErrorCode::kNotFound);
}

/// A video of three pictures at 30 per second.
constexpr const char* kVideo = "apriltag/wpilib/short.mp4";

TEST_F(FileCameraTest, replays_a_video_at_its_own_rate_and_loops) {
  CYCLORAMA_SHARED_DATA(video, kVideo);
  const auto camera = started(video, {});
  const TimePoint start = clock_.now();
  std::vector<std::shared_ptr<const CameraFrame>> frames;
  for (int i = 0; i < 8; ++i) {
    const auto frame = next(camera.get());
    ASSERT_TRUE(frame.has_value()) << frame.error().message();
    frames.push_back(*frame);
  }
  EXPECT_NEAR(to_seconds(clock_.now() - start), 7.0 / 30.0, 1e-6);
  EXPECT_NE(frames[0]->pixels, frames[1]->pixels);
  EXPECT_NE(frames[1]->pixels, frames[2]->pixels);
  for (std::size_t i = 3; i < frames.size(); ++i) EXPECT_EQ(frames[i]->pixels, frames[i - 3]->pixels) << i;
  const auto [darkest, lightest] =
      std::minmax_element(frames[0]->pixels.data().begin(), frames[0]->pixels.data().end());
  EXPECT_LT(*darkest, 20);
  EXPECT_GT(*lightest, 200);
}

TEST_F(FileCameraTest, gives_a_late_caller_the_newest_picture_of_a_video) {
  CYCLORAMA_SHARED_DATA(video, kVideo);
  const auto camera = started(video, {1.0, true});
  const auto first = next(camera.get());
  ASSERT_TRUE(first.has_value());
  clock_.advance(std::chrono::seconds(3000));
  const auto late = next(camera.get());
  ASSERT_TRUE(late.has_value());
  EXPECT_EQ((*late)->sequence, 3000U);
  EXPECT_EQ((*late)->pixels, (*first)->pixels);
}

TEST_F(FileCameraTest, ends_a_video_that_does_not_loop) {
  CYCLORAMA_SHARED_DATA(video, kVideo);
  const auto camera = started(video, {std::nullopt, false});
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(next(camera.get()).has_value());
  const auto ended = next(camera.get());
  ASSERT_FALSE(ended.has_value());
  EXPECT_THAT(ended.error().message(), HasSubstr("has ended"));
}

TEST_F(FileCameraTest, reads_or_refuses_a_truncated_or_damaged_video) {
  CYCLORAMA_SHARED_DATA(video, kVideo);
  const auto whole = read_text_file(video, 1 << 20);
  ASSERT_TRUE(whole.has_value());
  int refused = 0;
  for (std::size_t i = 1; i < 40; ++i) {
    std::string bytes = *whole;
    bytes[i * 1601] = static_cast<char>(bytes[i * 1601] ^ 0x55);
    put_file("v.mp4", i % 2 == 0 ? bytes : std::string_view(bytes).substr(0, i * 1650));
    auto camera = FileCamera::open(folder_ / "v.mp4", {}, clock_);
    if (!camera) {
      ++refused;
      continue;
    }
    ASSERT_TRUE((*camera)->start().has_value());
    for (int picture = 0; picture < 5; ++picture) static_cast<void>(next(camera->get()).has_value());
  }
  EXPECT_GT(refused, 0);
}

TEST_F(FileCameraTest, reads_or_refuses_every_damaged_photo) {
  int frames = 0;
  int refusals = 0;
  for (const char* name : {"bad/go_fuzz_jpeg", "bad/go_fuzz_png", "bad/afl_jpeg"}) {
    CYCLORAMA_SHARED_DATA(set, name);
    for (const auto& entry : std::filesystem::recursive_directory_iterator(set)) {
      if (!entry.is_regular_file()) continue;
      auto camera = FileCamera::open(entry.path(), {}, clock_);
      if (!camera) {
        ++refusals;
        EXPECT_THAT(camera.error().message(), HasSubstr(entry.path().filename().string()));
        continue;
      }
      ASSERT_TRUE((*camera)->start().has_value());
      const auto frame = next(camera->get());
      ASSERT_TRUE(frame.has_value()) << entry.path();
      EXPECT_FALSE((*frame)->pixels.empty());
      ++frames;
    }
  }
  RecordProperty("frames", frames);
  RecordProperty("refusals", refusals);
  EXPECT_GT(frames + refusals, 100);
}

}  // namespace
}  // namespace cyclorama::camera
