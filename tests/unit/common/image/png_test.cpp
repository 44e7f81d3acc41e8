// SPDX-License-Identifier: Apache-2.0
#include "common/image/png.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <random>
#include <string>

#include "common/image/image_file.h"

namespace cyclorama {
namespace {

RgbImage noise(int width, int height) {
  RgbImage image(width, height);
  std::mt19937 random(1);
  for (std::uint8_t& value : image.data()) value = static_cast<std::uint8_t>(random());
  return image;
}

TEST(Png, survives_a_round_trip_with_opaque_alpha) {
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{3, 200}, std::pair{257, 31}}) {
    const RgbImage image = noise(width, height);
    const auto png = encode_png(image);
    ASSERT_TRUE(png.has_value());
    const auto back = decode_png(*png, kTextureLimitPx);
    ASSERT_TRUE(back.has_value());
    ASSERT_EQ(back->width(), width);
    ASSERT_EQ(back->height(), height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        for (int c = 0; c < 3; ++c) ASSERT_EQ(back->at(x, y)[c], image.at(x, y)[c]);
        ASSERT_EQ(back->at(x, y)[3], 255);
      }
    }
  }
}

TEST(Png, refuses_truncated_damaged_and_oversized_files) {
  const auto png = encode_png(noise(64, 48));
  ASSERT_TRUE(png.has_value());
  EXPECT_FALSE(decode_png(*png, 64 * 48 - 1).has_value());
  for (std::size_t length = 0; length + 16 < png->size(); length += 101) {
    const auto part = decode_png(std::span(*png).first(length), kTextureLimitPx);
    ASSERT_FALSE(part.has_value()) << length;
    EXPECT_EQ(part.error().code(), ErrorCode::kBadData);
  }
  std::vector<std::byte> flipped = *png;
  flipped[flipped.size() / 2] ^= std::byte{0x10};  // In the pixels; detected by their checksum.
  EXPECT_FALSE(decode_png(flipped, kTextureLimitPx).has_value());
}

TEST(Png, cannot_write_an_empty_picture) {
  EXPECT_EQ(encode_png(RgbImage()).error().code(), ErrorCode::kInvalidArgument);
}

TEST(Png, reads_a_file_by_its_content_and_names_it_in_errors) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("png_test_" + std::to_string(::getpid()) + ".jpg");
  ASSERT_TRUE(write_png(path, noise(8, 8)).has_value());
  EXPECT_TRUE(read_image(path, kTextureLimitPx).has_value());
  const auto too_large = read_image(path, 63);
  ASSERT_FALSE(too_large.has_value());
  EXPECT_NE(too_large.error().message().find(path.string()), std::string::npos);
  std::filesystem::remove(path);
  EXPECT_EQ(read_image(path, 64).error().code(), ErrorCode::kNotFound);
}

}  // namespace
}  // namespace cyclorama
