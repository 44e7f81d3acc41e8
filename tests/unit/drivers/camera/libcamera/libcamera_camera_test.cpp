// SPDX-License-Identifier: Apache-2.0
// Behaviour of the libcamera camera on a machine without one: it reports an error and leaks nothing.
#include "drivers/camera/libcamera/libcamera_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <thread>

#include "drivers/camera/libcamera/completed_requests.h"

namespace cyclorama::camera {
namespace {

using std::chrono::seconds;

std::size_t open_files() {
  const auto begin = std::filesystem::directory_iterator("/proc/self/fd");
  return static_cast<std::size_t>(std::distance(begin, std::filesystem::directory_iterator{}));
}

TEST(LibcameraCamera, reports_a_missing_camera_and_leaks_nothing) {
  const SteadyClock clock;
  std::size_t files = 0;
  for (int i = 0; i < 4; ++i) {
    const auto camera = open_libcamera_camera("no such camera", {}, clock);
    ASSERT_FALSE(camera.has_value());
    EXPECT_THAT(camera.error().code(),
                testing::AnyOf(ErrorCode::kNotFound, ErrorCode::kUnavailable, ErrorCode::kInvalidArgument));
    EXPECT_FALSE(camera.error().message().empty());
    if (i == 1) files = open_files();
    if (i > 1) {
      EXPECT_EQ(open_files(), files);
    }
  }
}

TEST(LibcameraCamera, lists_the_cameras) {
  for (const ListedCamera& camera : list_libcamera_cameras()) {
    EXPECT_TRUE(camera.spec.starts_with("libcamera:"));
    EXPECT_FALSE(camera.name.empty());
  }
}

TEST(CompletedRequests, returns_all_that_is_finished_oldest_first) {
  CompletedRequests<int> completed;
  int first = 1;
  int second = 2;
  EXPECT_TRUE(completed.take_before(SteadyClock().now()).empty());
  completed.put(&first);
  completed.put(&second);
  EXPECT_THAT(completed.take_before(SteadyClock().now()), testing::ElementsAre(&first, &second));
  EXPECT_TRUE(completed.take_before(SteadyClock().now()).empty());
}

TEST(CompletedRequests, wakes_a_waiting_thread_for_a_picture_and_at_the_end) {
  CompletedRequests<int> completed;
  int request = 1;
  {
    std::jthread driver([&] { completed.put(&request); });
    EXPECT_THAT(completed.take_before(SteadyClock().now() + seconds(20)), testing::ElementsAre(&request));
  }
  std::jthread driver([&] { completed.end(); });
  EXPECT_TRUE(completed.take_before(SteadyClock().now() + seconds(20)).empty());
  EXPECT_TRUE(completed.has_ended());
}

}  // namespace
}  // namespace cyclorama::camera
