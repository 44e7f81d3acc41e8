// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/watermark_curve.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/image/watermark_detector.h"

namespace cyclorama::render {
namespace {

RgbImage waves(int width, int height) {
  RgbImage picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double value = 128.0 + 70.0 * std::sin(0.02 * x + 0.013 * y) + (x * 7919 + y * 104729) % 7;
      for (int c = 0; c < 3; ++c) picture.at(x, y)[c] = static_cast<std::uint8_t>(value);
    }
  }
  return picture;
}

TEST(WatermarkCurve, cost_and_detection_increase_with_the_strength) {
  EXPECT_EQ(measure_watermark(waves(63, 400)).error().code(), ErrorCode::kInvalidArgument);
  const auto points = measure_watermark(waves(512, 384));
  ASSERT_TRUE(points) << points.error().message();
  const WatermarkPoint* before = nullptr;
  bool has_standard = false;
  for (const WatermarkPoint& point : *points) {
    if (before != nullptr && before->strength.amplitude == point.strength.amplitude) {
      EXPECT_LT(point.grey_psnr_db, before->grey_psnr_db);
      EXPECT_GT(point.grey_flip, before->grey_flip);
      EXPECT_GT(point.scores[0], before->scores[0]);
    }
    before = &point;
    if (point.strength.amplitude != WatermarkStrength{}.amplitude ||
        point.strength.sparseness != WatermarkStrength{}.sparseness) {
      continue;
    }
    has_standard = true;
    EXPECT_GE(point.grey_psnr_db, 42.0);
    EXPECT_LE(point.grey_flip, 0.01);
    EXPECT_GE(point.scores[2], kWatermarkCertain);  // JPEG of quality 75.
  }
  EXPECT_TRUE(has_standard);
}

}  // namespace
}  // namespace cyclorama::render
