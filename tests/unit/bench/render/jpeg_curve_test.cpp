// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/jpeg_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace cyclorama::render {
namespace {

RgbImage rings(int width, int height) {
  RgbImage picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double value = 128.0 + 100.0 * std::sin(0.002 * (x * x + y * y));
      for (int c = 0; c < 3; ++c) picture.at(x, y)[c] = static_cast<std::uint8_t>(value / (1 + c));
    }
  }
  return picture;
}

TEST(JpegCurve, higher_quality_costs_bytes_and_reduces_the_error) {
  const auto points = measure_jpeg(rings(160, 96));
  ASSERT_TRUE(points) << points.error().message();
  const JpegPoint* before = nullptr;
  for (const JpegPoint& point : *points) {
    EXPECT_GT(point.bytes, 0u);
    EXPECT_GT(point.encode_ms_per_megapixel, 0.0);
    EXPECT_GT(point.decode_ms_per_megapixel, 0.0);
    if (before != nullptr && before->tile_px == point.tile_px &&
        before->options.subsample_chroma == point.options.subsample_chroma &&
        before->options.quality < point.options.quality) {
      EXPECT_GT(point.bytes, before->bytes);
      EXPECT_GT(point.error.psnr_db, before->error.psnr_db);
    }
    before = &point;
  }
}

TEST(JpegCurve, small_tiles_cost_bytes) {
  const auto points = measure_jpeg(rings(384, 272));
  ASSERT_TRUE(points) << points.error().message();
  std::map<int, std::size_t> bytes;
  for (const JpegPoint& point : *points) {
    if (point.options.quality == 85 && point.options.subsample_chroma) bytes[point.tile_px] = point.bytes;
  }
  EXPECT_LT(bytes.at(256), bytes.at(128));
  EXPECT_LT(bytes.at(128), bytes.at(64));
  EXPECT_LT(bytes.at(64), bytes.at(32));
}

TEST(JpegCurve, refuses_a_picture_smaller_than_the_smallest_tile) {
  EXPECT_EQ(measure_jpeg(rings(31, 400)).error().code(), ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace cyclorama::render
