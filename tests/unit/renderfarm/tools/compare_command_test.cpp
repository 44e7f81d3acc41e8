// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/tools/compare_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <limits>

#include "common/base/file.h"
#include "common/image/pfm.h"
#include "common/image/png.h"

namespace cyclorama::tools {
namespace {

using testing::HasSubstr;

class CompareFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) / ("compare_command_test_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path light(const char* name, float value, int width = 16, int height = 12) {
    EXPECT_TRUE(write_pfm(folder_ / name, RadianceImage(width, height, value)).has_value());
    return folder_ / name;
  }
  std::filesystem::path codes(const char* name, int value) {
    EXPECT_TRUE(write_png(folder_ / name, RgbImage(16, 12, static_cast<std::uint8_t>(value))).has_value());
    return folder_ / name;
  }
  std::filesystem::path folder_;
};

TEST_F(CompareFiles, compares_two_light_files_in_light_and_as_displayed) {
  const auto result = compare_files(light("a.pfm", 0.3f), light("b.pfm", 0.2f));
  ASSERT_TRUE(result.has_value()) << result.error().message();
  ASSERT_TRUE(result->light.has_value());
  EXPECT_NEAR(result->light->mse, 0.01, 1e-7);
  EXPECT_NEAR(result->light->relmse, 0.01 / 0.05, 1e-6);
  EXPECT_GT(result->shown.flip, 0.05);
  EXPECT_LT(result->shown.ssim, 1.0);
}

TEST_F(CompareFiles, has_no_error_of_light_for_code_values) {
  const auto result = compare_files(codes("a.png", 100), codes("b.png", 110));
  ASSERT_TRUE(result.has_value()) << result.error().message();
  EXPECT_FALSE(result->light.has_value());
  EXPECT_NEAR(result->shown.psnr_db, 28.1308036, 1e-6);
}

TEST_F(CompareFiles, tone_maps_light_before_comparing_it_with_code_values) {
  const auto result = compare_files(light("a.pfm", 1e30f), codes("b.png", 255));
  ASSERT_TRUE(result.has_value()) << result.error().message();
  EXPECT_FALSE(result->light.has_value());
  EXPECT_TRUE(std::isinf(result->shown.psnr_db));
  EXPECT_EQ(result->shown.flip, 0.0);
}

TEST_F(CompareFiles, reports_light_that_is_not_finite_with_file_and_position) {
  const auto result = compare_files(codes("a.png", 0), light("bad.pfm", std::numeric_limits<float>::quiet_NaN()));
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code(), ErrorCode::kBadData);
  EXPECT_THAT(result.error().message(), testing::AllOf(HasSubstr("bad.pfm"), HasSubstr("(0, 0) is nan")));
}

TEST_F(CompareFiles, refuses_different_sizes_missing_files_and_other_formats) {
  EXPECT_EQ(compare_files(light("a.pfm", 1.0f, 12, 16), codes("b.png", 0)).error().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(compare_files(folder_ / "none.png", codes("b.png", 0)).error().code(), ErrorCode::kNotFound);
  ASSERT_TRUE(write_file_atomically(folder_ / "text.png", std::string_view("PNG, really")).has_value());
  const auto result = compare_files(folder_ / "text.png", codes("b.png", 0));
  EXPECT_EQ(result.error().code(), ErrorCode::kBadData);
  EXPECT_THAT(result.error().message(), HasSubstr("text.png"));
}

}  // namespace
}  // namespace cyclorama::tools
