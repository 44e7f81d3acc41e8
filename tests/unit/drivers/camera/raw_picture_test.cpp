// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/raw_picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <vector>

namespace cyclorama::camera {
namespace {

using testing::HasSubstr;

constexpr int kWidth = 5;
constexpr int kHeight = 4;

std::uint8_t level(int x, int y) { return static_cast<std::uint8_t>(10 * y + 50 * x + 3); }

/// Value of bytes that are not brightness; bright enough to be noticed.
constexpr std::byte kNoise{0xee};

struct Written {
  RawPicture raw;
  std::vector<std::byte> bytes;
};

/// Writes a picture of level() in rows with `padding` bytes; the last row has none, since drivers may omit it.
Written write(PixelLayout layout, std::size_t padding) {
  Written written;
  const std::size_t row = kWidth * bytes_per_pixel(layout);
  written.raw = {layout, kWidth, kHeight, row + padding, {}};
  written.bytes.assign((row + padding) * kHeight - padding, kNoise);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      std::byte* const pixel = written.bytes.data() + static_cast<std::size_t>(y) * (row + padding) +
                               static_cast<std::size_t>(x) * bytes_per_pixel(layout);
      const int surplus = layout == PixelLayout::kGrey16 ? 8 : layout == PixelLayout::kGrey12 ? 4 : 2;
      const unsigned deep = (static_cast<unsigned>(level(x, y)) << static_cast<unsigned>(surplus)) | 3U;
      switch (layout) {
        case PixelLayout::kGrey8:
        case PixelLayout::kPlanarYuv:
        case PixelLayout::kYuyv:
          pixel[0] = static_cast<std::byte>(level(x, y));
          break;
        case PixelLayout::kUyvy:
          pixel[1] = static_cast<std::byte>(level(x, y));
          break;
        default:
          pixel[0] = static_cast<std::byte>(deep & 0xffU);
          pixel[1] = static_cast<std::byte>(deep >> 8U);
      }
    }
  }
  return written;
}

class ToGrey : public testing::TestWithParam<PixelLayout> {};

TEST_P(ToGrey, reads_only_brightness) {
  JpegDecoder jpeg;
  for (const std::size_t padding : {0U, 1U, 7U, 64U}) {
    Written written = write(GetParam(), padding);
    written.raw.bytes = written.bytes;
    GreyImage grey;
    const auto done = to_grey(written.raw, &jpeg, &grey);
    ASSERT_TRUE(done.has_value()) << done.error().message();
    ASSERT_EQ(grey.width(), kWidth);
    ASSERT_EQ(grey.height(), kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) EXPECT_EQ(*grey.at(x, y), level(x, y)) << x << " " << y;
    }
  }
}

TEST_P(ToGrey, refuses_a_picture_that_is_one_byte_short) {
  JpegDecoder jpeg;
  for (const std::size_t padding : {0U, 7U}) {
    const Written written = write(GetParam(), padding);
    GreyImage grey;
    for (std::size_t bytes = 0; bytes < written.bytes.size(); ++bytes) {
      // Copies exactly that length, so that a sanitizer detects an access of one byte too far.
      const std::vector<std::byte> cut(written.bytes.begin(),
                                       written.bytes.begin() + static_cast<std::ptrdiff_t>(bytes));
      RawPicture raw = written.raw;
      raw.bytes = cut;
      const auto done = to_grey(raw, &jpeg, &grey);
      ASSERT_FALSE(done.has_value()) << bytes;
      EXPECT_EQ(done.error().code(), ErrorCode::kBadData);
    }
  }
}

TEST_P(ToGrey, refuses_invalid_sizes) {
  JpegDecoder jpeg;
  Written written = write(GetParam(), 0);
  written.raw.bytes = written.bytes;
  GreyImage grey;
  const std::size_t row = written.raw.row_bytes;
  for (const auto& [width, height, row_bytes] :
       {std::tuple{0, kHeight, row}, std::tuple{kWidth, 0, row}, std::tuple{-1, kHeight, row},
        std::tuple{kWidth, kHeight, row - 1}, std::tuple{kWidth, kHeight, std::size_t{0}},
        std::tuple{1 << 30, 1 << 30, std::size_t{1} << 31}, std::tuple{kWidth, kHeight, SIZE_MAX / 2}}) {
    RawPicture raw = written.raw;
    raw.width = width;
    raw.height = height;
    raw.row_bytes = row_bytes;
    EXPECT_FALSE(to_grey(raw, &jpeg, &grey).has_value()) << width << "x" << height << " in " << row_bytes;
  }
}

INSTANTIATE_TEST_SUITE_P(AllLayouts, ToGrey,
                         testing::Values(PixelLayout::kGrey8, PixelLayout::kPlanarYuv, PixelLayout::kGrey10,
                                         PixelLayout::kGrey12, PixelLayout::kGrey16, PixelLayout::kYuyv,
                                         PixelLayout::kUyvy));

TEST(ToGreyOfDeepPixels, keeps_white_when_a_driver_sets_bits_above_the_promised_ones) {
  JpegDecoder jpeg;
  const std::vector<std::byte> bytes{std::byte{0xff}, std::byte{0xff}};
  GreyImage grey;
  ASSERT_TRUE(to_grey({PixelLayout::kGrey10, 1, 1, 2, bytes}, &jpeg, &grey).has_value());
  EXPECT_EQ(*grey.at(0, 0), 255);
}

std::vector<std::byte> jpeg_of(int width, int height, std::uint8_t grey) {
  RgbImage picture(width, height, grey);
  JpegEncoder encoder;
  return *encoder.encode(picture, {90, true});
}

TEST(ToGreyOfJpeg, decodes_and_checks_the_size) {
  JpegDecoder jpeg;
  const auto bytes = jpeg_of(32, 16, 77);
  GreyImage grey;
  ASSERT_TRUE(to_grey({PixelLayout::kJpeg, 32, 16, 0, bytes}, &jpeg, &grey).has_value());
  EXPECT_NEAR(*grey.at(20, 10), 77, 2);
  const auto other = to_grey({PixelLayout::kJpeg, 16, 16, 0, bytes}, &jpeg, &grey);
  ASSERT_FALSE(other.has_value());
  EXPECT_THAT(other.error().message(), HasSubstr("32x16 instead of 16x16"));
  for (std::size_t cut = 0; cut < bytes.size(); cut += 13) {
    EXPECT_FALSE(to_grey({PixelLayout::kJpeg, 32, 16, 0, std::span(bytes).first(cut)}, &jpeg, &grey).has_value())
        << cut;
  }
}

/// UVC cameras omit the Huffman tables, as the AVI format of 1996 does, and pad their buffers with zeros.
TEST(ToGreyOfJpeg, decodes_a_cameras_jpeg_without_huffman_tables) {
  JpegDecoder jpeg;
  std::vector<std::byte> bytes = jpeg_of(32, 16, 90);
  for (std::size_t at = 2; at + 4 <= bytes.size() && bytes[at] == std::byte{0xff};) {
    const std::size_t length =
        2 + (static_cast<std::size_t>(bytes[at + 2]) << 8U) + static_cast<std::size_t>(bytes[at + 3]);
    const bool is_table = bytes[at + 1] == std::byte{0xc4};
    if (bytes[at + 1] == std::byte{0xda}) break;
    if (is_table) {
      bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                  bytes.begin() + static_cast<std::ptrdiff_t>(at + length));
    } else {
      at += length;
    }
  }
  bytes.resize(bytes.size() + 512, std::byte{0});
  GreyImage grey;
  const auto done = to_grey({PixelLayout::kJpeg, 32, 16, 0, bytes}, &jpeg, &grey);
  ASSERT_TRUE(done.has_value()) << done.error().message();
  EXPECT_NEAR(*grey.at(20, 10), 90, 2);
}

using Rgb = std::array<int, 3>;

/// Converts red, green and blue to a camera's codes by the standard's formulas.
Rgb yuv_of(const Rgb& rgb, bool is_full_range) {
  const double y = 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2];
  const double u = (rgb[2] - y) / 1.772;
  const double v = (rgb[0] - y) / 1.402;
  const auto code = [](double value) { return static_cast<int>(std::lround(value)); };
  if (is_full_range) return {code(y), code(u + 128), code(v + 128)};
  return {code(16 + y * 219 / 255), code(128 + u * 224 / 255), code(128 + v * 224 / 255)};
}

/// One colour per two columns and rows, so that no chroma sample covers two colours; odd sizes, so that the last one
/// covers only half of its pixels.
Rgb colour_at(int x, int y) { return {40 + 50 * (x / 2), 200 - 60 * (y / 2), 90 + 40 * (x / 2)}; }

struct CodedPicture {
  RawPicture raw;
  std::vector<std::byte> bytes;
};

CodedPicture coded(PixelLayout layout, const ColourCode& colour, std::size_t padding) {
  CodedPicture picture;
  const std::size_t row = 6 * bytes_per_pixel(layout) + padding;
  const bool is_between = colour.chroma == Chroma::kBetween;
  picture.raw = {layout, kWidth, kHeight, row, {}, colour};
  picture.bytes.assign(row * (is_between ? kHeight : kHeight + kHeight / 2) - padding, kNoise);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Rgb yuv = yuv_of(colour_at(x, y), colour.is_full_range);
      const auto put = [&](std::size_t at, int value) { picture.bytes[at] = static_cast<std::byte>(value); };
      const std::size_t start = static_cast<std::size_t>(y) * row;
      const std::size_t plane = (kHeight + static_cast<std::size_t>(y) / 2) * row;
      const auto column = static_cast<std::size_t>(x);
      const std::size_t pair = column / 2 * 2;
      const std::size_t first = layout == PixelLayout::kUyvy ? 1 : 0;
      put(is_between ? start + 2 * column + first : start + column, yuv[0]);
      const std::size_t chroma = is_between ? start + 2 * pair + 1 - first : plane + pair;
      put(chroma, yuv[colour.is_v_first ? 2 : 1]);
      put(chroma + (is_between ? 2 : 1), yuv[colour.is_v_first ? 1 : 2]);
    }
  }
  return picture;
}

TEST(ToColour, agrees_with_the_standards_formulas) {
  JpegDecoder jpeg;
  for (const auto& [layout, chroma] :
       {std::pair(PixelLayout::kYuyv, Chroma::kBetween), std::pair(PixelLayout::kUyvy, Chroma::kBetween),
        std::pair(PixelLayout::kPlanarYuv, Chroma::kPairs)}) {
    for (int variant = 0; variant < 8; ++variant) {
      const ColourCode code{chroma, (variant & 1) != 0, (variant & 2) != 0};
      CodedPicture picture = coded(layout, code, (variant & 4) != 0 ? 7 : 0);
      picture.raw.bytes = picture.bytes;
      RgbImage rgb;
      const auto done = to_colour(picture.raw, &jpeg, &rgb);
      ASSERT_TRUE(done.has_value()) << done.error().message();
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          const Rgb colour = colour_at(x, y);
          for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_NEAR(rgb.at(x, y)[c], colour[c], 2) << name_of(layout) << " " << variant << ": " << x << " " << y;
          }
        }
      }
    }
  }
}

TEST(ToColour, refuses_a_picture_that_is_one_byte_short) {
  JpegDecoder jpeg;
  RgbImage rgb;
  for (const auto& [layout, chroma] :
       {std::pair(PixelLayout::kYuyv, Chroma::kBetween), std::pair(PixelLayout::kPlanarYuv, Chroma::kPairs)}) {
    const CodedPicture picture = coded(layout, {chroma, false, false}, 3);
    for (std::size_t bytes = 0; bytes < picture.bytes.size(); ++bytes) {
      const std::vector<std::byte> cut(picture.bytes.begin(),
                                       picture.bytes.begin() + static_cast<std::ptrdiff_t>(bytes));
      RawPicture raw = picture.raw;
      raw.bytes = cut;
      const auto done = to_colour(raw, &jpeg, &rgb);
      ASSERT_FALSE(done.has_value()) << bytes;
      EXPECT_EQ(done.error().code(), ErrorCode::kBadData);
    }
  }
}

TEST(ToColour, clips_impossible_colours) {
  JpegDecoder jpeg;
  RgbImage rgb;
  const std::vector<std::byte> bytes{std::byte{255}, std::byte{255}, std::byte{0}, std::byte{255}};
  ASSERT_TRUE(to_colour({PixelLayout::kYuyv, 2, 1, 4, bytes, {Chroma::kBetween, false, false}}, &jpeg, &rgb));
  EXPECT_EQ(rgb.at(0, 0)[0], 255);
  EXPECT_EQ(rgb.at(1, 0)[1], 0);
}

TEST(ToColour, decodes_a_jpeg) {
  JpegDecoder jpeg;
  RgbImage rgb;
  RgbImage red(32, 16, 20);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 32; ++x) red.at(x, y)[0] = 220;
  }
  const auto bytes = *JpegEncoder().encode(red, {95, true});
  ASSERT_TRUE(to_colour({PixelLayout::kJpeg, 32, 16, 0, bytes, {Chroma::kInJpeg, false, true}}, &jpeg, &rgb));
  EXPECT_NEAR(rgb.at(9, 9)[0], 220, 3);
  EXPECT_NEAR(rgb.at(9, 9)[2], 20, 3);
  EXPECT_FALSE(to_colour({PixelLayout::kJpeg, 16, 16, 0, bytes, {Chroma::kInJpeg, false, true}}, &jpeg, &rgb));
}

}  // namespace
}  // namespace cyclorama::camera
