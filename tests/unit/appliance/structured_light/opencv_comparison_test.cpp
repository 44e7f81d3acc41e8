// SPDX-License-Identifier: Apache-2.0
/// Compares patterns and decoding with OpenCV's structured-light module.
#include <gmock/gmock.h>

#include <opencv2/structured_light/graycodepattern.hpp>

#include "appliance/structured_light/pattern_drawing.h"
#include "tests/data_sets/lit_wall.h"

namespace cyclorama::structured_light {
namespace {

TEST(OpenCvComparison, patterns_are_the_same_pictures_in_the_same_order) {
  for (const auto& [width, height] : {std::pair{128, 96}, std::pair{100, 70}}) {
    const auto set = structured_light({.width_px = width, .height_px = height});
    ASSERT_TRUE(set.has_value());
    std::vector<cv::Mat> theirs;
    ASSERT_TRUE(cv::structured_light::GrayCodePattern::create(width, height)->generate(theirs));
    ASSERT_EQ(set->pictures.size(), theirs.size() + 2);
    for (std::size_t i = 0; i < theirs.size(); ++i) {
      const RgbImage ours = drawn(*set, set->pictures[i + 2]);
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          ASSERT_EQ(ours.at(x, y)[0], theirs[i].at<std::uint8_t>(y, x))
              << name_of(set->pictures[i + 2]) << " at " << x << ", " << y;
        }
      }
    }
  }
}

TEST(OpenCvComparison, decodes_to_the_same_stripes_and_decodes_more_pixels) {
  LitWall wall;
  wall.noise = 0.008;
  const auto set = structured_light({.width_px = 128, .height_px = 96});
  ASSERT_TRUE(set.has_value());
  const auto decoded = wall.decoder(*set).finish();
  ASSERT_TRUE(decoded.has_value());
  std::vector<cv::Mat> photographs;
  for (std::size_t i = 2; i < set->pictures.size(); ++i) {
    const Photo photo = wall.photograph(*set, i);
    cv::Mat codes(photo.height(), photo.width(), CV_8UC1);
    for (int y = 0; y < photo.height(); ++y) {
      for (int x = 0; x < photo.width(); ++x)
        codes.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(std::lround(255.0f * *photo.at(x, y)));
    }
    photographs.push_back(codes);
  }
  const auto theirs = cv::structured_light::GrayCodePattern::create(128, 96);
  theirs->setWhiteThreshold(10);
  int decoded_by_them = 0;
  int decoded_by_us = 0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      cv::Point position;
      const bool is_theirs = !theirs->getProjPixel(photographs, x, y, position);
      const bool is_ours = *decoded->fate.at(x, y) == PixelFate::kDecoded;
      decoded_by_them += is_theirs ? 1 : 0;
      decoded_by_us += is_ours ? 1 : 0;
      if (!is_theirs || !is_ours) continue;
      EXPECT_NEAR(decoded->position_px.at(x, y)[0], position.x + 0.5, 1.0) << x << ", " << y;
      EXPECT_NEAR(decoded->position_px.at(x, y)[1], position.y + 0.5, 1.0) << x << ", " << y;
    }
  }
  EXPECT_GT(decoded_by_them, 1000);
  EXPECT_GT(decoded_by_us, decoded_by_them);
}

}  // namespace
}  // namespace cyclorama::structured_light
