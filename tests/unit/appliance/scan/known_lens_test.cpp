// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/known_lens.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include "appliance/calibration/camera_file.h"
#include "common/base/file.h"

namespace cyclorama::scan {
namespace {

using ::testing::HasSubstr;

class KnownLens : public ::testing::Test {
 protected:
  KnownLens() : folder_(std::filesystem::path(::testing::TempDir()) / ("lens-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
    file_.camera = "v4l2:usb-1";
    file_.date = "2026-01-01";
    file_.lens = calibration::MeasuredLens::from_focal(1280, 720, 1000.0);
    file_.lens.values[calibration::MeasuredLens::kK1] = -0.1;
    file_.views = 12;
  }
  ~KnownLens() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  void write(const std::string& name) {
    ASSERT_TRUE(write_file_atomically(folder_ / name, calibration::camera_json(file_)).has_value());
  }
  std::filesystem::path folder_;
  calibration::CameraFile file_;
};

TEST_F(KnownLens, is_empty_without_a_lens_file) {
  const auto lens = known_lens({}, folder_, "v4l2:usb-1", 1280, 720);
  ASSERT_TRUE(lens.has_value());
  EXPECT_FALSE(lens->has_value());
}

TEST_F(KnownLens, is_found_by_the_cameras_id_with_its_covariance) {
  write("camera.json");
  const auto lens = known_lens({}, folder_, "v4l2:usb-1", 640, 360);
  ASSERT_TRUE(lens.has_value() && lens->has_value());
  EXPECT_DOUBLE_EQ((*lens)->values[calibration::MeasuredLens::kFocal], 500.0) << "pictures of half the size";
  EXPECT_DOUBLE_EQ((*lens)->values[calibration::MeasuredLens::kK1], -0.1);
  EXPECT_DOUBLE_EQ((*lens)->covariance(0, 0), 0.25 * file_.lens.covariance(0, 0));
  EXPECT_FALSE(known_lens({}, folder_, "v4l2:usb-2", 640, 360)->has_value()) << "another camera's";
}

TEST_F(KnownLens, must_exist_and_fit_if_it_is_named) {
  EXPECT_THAT(known_lens(folder_ / "mine.json", folder_, "x", 1280, 720).error().message(), HasSubstr("mine.json"));
  write("mine.json");
  EXPECT_TRUE(known_lens(folder_ / "mine.json", folder_, "another id", 1280, 720)->has_value());
  EXPECT_EQ(known_lens(folder_ / "mine.json", folder_, "x", 1024, 1024).error().code(), ErrorCode::kInvalidArgument);
  ASSERT_TRUE(write_file_atomically(folder_ / "camera.json", std::string_view("{")).has_value());
  EXPECT_EQ(known_lens({}, folder_, "x", 1280, 720).error().code(), ErrorCode::kBadData) << "damaged is not absent";
}

}  // namespace
}  // namespace cyclorama::scan
