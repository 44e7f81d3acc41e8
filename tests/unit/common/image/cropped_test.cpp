// SPDX-License-Identifier: Apache-2.0
#include "common/image/cropped.h"

#include <gtest/gtest.h>

namespace cyclorama {
namespace {

RgbImage numbered(int width, int height) {
  RgbImage picture(width, height);
  for (std::size_t i = 0; i < picture.data().size(); ++i) picture.data()[i] = static_cast<std::uint8_t>(i);
  return picture;
}

TEST(Cropped, takes_only_the_pixels_of_the_part) {
  const RgbImage picture = numbered(7, 5);
  const RgbImage part = cropped(picture, {2, 1, 4, 3});
  ASSERT_EQ(part.width(), 4);
  ASSERT_EQ(part.height(), 3);
  for (int y = 0; y < 3; ++y) {
    for (int i = 0; i < 12; ++i) EXPECT_EQ(part.at(0, y)[i], picture.at(2, 1 + y)[i]);
  }
}

TEST(Cropped, returns_the_whole_picture_or_an_empty_one) {
  const RgbImage picture = numbered(7, 5);
  EXPECT_EQ(cropped(picture, {0, 0, 7, 5}), picture);
  EXPECT_TRUE(cropped(picture, {7, 5, 0, 0}).empty());
  EXPECT_DEATH((void)cropped(picture, {4, 0, 4, 5}), "");
}

}  // namespace
}  // namespace cyclorama
