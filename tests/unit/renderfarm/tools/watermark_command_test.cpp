// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/tools/watermark_command.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cyclorama::tools {
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

TEST(FindMuseum, finds_one_of_several) {
  const auto grants = trust::Grants::parse(
      "[[museum]]\nname = \"a\"\nscenes = [\"*\"]\nwatermark = \"000000000000000b\"\n"
      "[[museum]]\nname = \"b\"\nscenes = [\"*\"]\nwatermark = \"000000000000000c\"\n"
      "[[museum]]\nname = \"none\"\nscenes = [\"*\"]\n"
      "[[museum]]\nname = \"c\"\nscenes = [\"*\"]\nwatermark = \"000000000000000d\"\n",
      "museums.toml");
  ASSERT_TRUE(grants) << grants.error().message();
  RgbImage picture = waves(640, 480);
  EXPECT_LT(find_museum(picture, *grants).front().find.score, kWatermarkCertain);
  add_watermark(12, {0, 0, 640, 480}, &picture);
  const auto verdicts = find_museum(picture, *grants);
  ASSERT_EQ(verdicts.size(), 3u);
  EXPECT_EQ(verdicts[0].museum, "b");
  EXPECT_GT(verdicts[0].find.score, kWatermarkCertain);
  EXPECT_LT(verdicts[1].find.score, kWatermarkCertain);
}

}  // namespace
}  // namespace cyclorama::tools
