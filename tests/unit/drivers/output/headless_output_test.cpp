// SPDX-License-Identifier: Apache-2.0
// Behaviour of the headless output beyond the contract of Output: it shares its heads' pictures.
#include "drivers/output/headless/headless_output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "drivers/output/shared_picture.h"

namespace cyclorama::output {
namespace {

class HeadlessOutputTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string folder = ::testing::TempDir() + "/headless.XXXXXX";
    ASSERT_NE(::mkdtemp(folder.data()), nullptr);
    run_dir_ = folder;
  }
  void TearDown() override { std::filesystem::remove_all(run_dir_); }

  HeadlessOptions options() const { return {{{"left", 64, 48}}, 200.0, run_dir_, {}, &is_awake_}; }
  /// Returns the information about the head's newest picture.
  SharedPictureInfo info() {
    auto reader = SharedPictureReader::open(shared_picture_path(run_dir_, "left"));
    EXPECT_TRUE(reader);
    RgbImage picture;
    const auto info = reader->read_newest(&picture);
    EXPECT_TRUE(info) << info.error().message();
    return info ? *info : SharedPictureInfo{};
  }
  SteadyClock clock_;
  std::atomic<bool> is_awake_{true};
  std::filesystem::path run_dir_;
};

TEST_F(HeadlessOutputTest, publishes_each_picture_with_its_time) {
  auto output = open_headless_output(options(), clock_);
  ASSERT_TRUE(output);
  ASSERT_TRUE((*output)->wait_for_refresh());
  ASSERT_TRUE((*output)->draw_to(0));
  const auto presented = (*output)->present();
  ASSERT_TRUE(presented);
  EXPECT_EQ(info().refresh, presented->refresh);
  EXPECT_EQ(info().presented_at, presented->at);
}

TEST_F(HeadlessOutputTest, publishes_nothing_if_nothing_is_new) {
  auto output = open_headless_output(options(), clock_);
  ASSERT_TRUE(output);
  ASSERT_TRUE((*output)->draw_to(0));
  for (int n = 0; n < 3; ++n) ASSERT_TRUE((*output)->present());
  EXPECT_EQ(info().picture, 1U);
  is_awake_ = false;  // A single black picture.
  for (int n = 0; n < 3; ++n) {
    ASSERT_TRUE((*output)->draw_to(0));
    ASSERT_TRUE((*output)->present());
  }
  EXPECT_EQ(info().picture, 2U);
}

TEST_F(HeadlessOutputTest, works_without_a_run_directory_but_refuses_a_missing_one) {
  HeadlessOptions opened = options();
  opened.run_dir.clear();
  auto output = open_headless_output(opened, clock_);
  ASSERT_TRUE(output) << output.error().message();
  ASSERT_TRUE((*output)->draw_to(0));
  ASSERT_TRUE((*output)->present());
  opened.run_dir = "/nowhere/at/all";
  EXPECT_EQ(open_headless_output(opened, clock_).error().code(), ErrorCode::kNotFound);
}

}  // namespace
}  // namespace cyclorama::output
