// SPDX-License-Identifier: Apache-2.0
#include "common/image/radiance_hdr.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "common/base/file.h"
#include "tests/data_sets/shared_data.h"

namespace cyclorama {
namespace {

constexpr std::size_t kLimitPx = std::size_t{1} << 22;

Result<RadianceImage> decoded(const std::string& text, std::size_t limit_px = kLimitPx) {
  return decode_radiance_hdr(std::as_bytes(std::span(text.data(), text.size())), limit_px);
}

std::string head(const std::string& resolution, const std::string& variables = "FORMAT=32-bit_rle_rgbe\n") {
  return "#?RADIANCE\n" + variables + "\n" + resolution + "\n";
}
std::string texel(int r, int g, int b, int e) {
  return {static_cast<char>(r), static_cast<char>(g), static_cast<char>(b), static_cast<char>(e)};
}
/// Encodes `channel` as one literal run of at most 128 bytes.
std::string literal(const std::string& channel) { return static_cast<char>(channel.size()) + channel; }
std::string run(int count, int value) { return {static_cast<char>(128 + count), static_cast<char>(value)}; }

TEST(RadianceHdr, scales_a_byte_by_its_exponent) {
  const auto image = decoded(head("-Y 1 +X 3") + texel(128, 64, 0, 129) + texel(255, 1, 2, 0) + texel(1, 2, 3, 136));
  ASSERT_TRUE(image.has_value()) << image.error().message();
  EXPECT_EQ(image->at(0, 0)[0], 1.0f);
  EXPECT_EQ(image->at(0, 0)[1], 0.5f);
  EXPECT_EQ(image->at(0, 0)[2], 0.0f);
  EXPECT_EQ(image->at(1, 0)[0], 0.0f);
  EXPECT_EQ(image->at(2, 0)[2], 3.0f);
}

TEST(RadianceHdr, decodes_runs_and_literals_of_each_channel) {
  const std::string row = "\x02\x02" + std::string(1, '\0') + "\x09" + run(9, 10) + literal("123456789") + run(4, 7) +
                          run(5, 8) + run(9, 136);
  const auto image = decoded(head("-Y 2 +X 9") + row + row);
  ASSERT_TRUE(image.has_value()) << image.error().message();
  for (int x = 0; x < 9; ++x) {
    EXPECT_EQ(image->at(x, 1)[0], 10.0f);
    EXPECT_EQ(image->at(x, 1)[1], static_cast<float>('1' + x));
    EXPECT_EQ(image->at(x, 1)[2], x < 4 ? 7.0f : 8.0f);
  }
}

TEST(RadianceHdr, decodes_the_older_runs_of_the_previous_texel) {
  const auto image =
      decoded(head("-Y 1 +X 300") + texel(5, 6, 7, 136) + texel(1, 1, 1, 42) + texel(1, 1, 1, 1) + texel(9, 9, 9, 136));
  ASSERT_TRUE(image.has_value()) << image.error().message();  // 1 + 42 + 256 + 1
  EXPECT_EQ(image->at(298, 0)[1], 6.0f);
  EXPECT_EQ(image->at(299, 0)[1], 9.0f);
}

/// Texels are numbered in stored order; the positions of the first and the last give the orientation.
TEST(RadianceHdr, turns_all_eight_orientations_upright) {
  struct Case {
    const char* resolution;
    std::array<int, 2> first, second;
  };
  for (const Case& c :
       {Case{"-Y 2 +X 3", {0, 0}, {1, 0}}, Case{"-Y 2 -X 3", {2, 0}, {1, 0}}, Case{"+Y 2 +X 3", {0, 1}, {1, 1}},
        Case{"+Y 2 -X 3", {2, 1}, {1, 1}}, Case{"+X 3 -Y 2", {0, 0}, {0, 1}}, Case{"+X 3 +Y 2", {0, 1}, {0, 0}},
        Case{"-X 3 -Y 2", {2, 0}, {2, 1}}, Case{"-X 3 +Y 2", {2, 1}, {2, 0}}}) {
    std::string texels;
    for (int i = 2; i < 8; ++i) texels += texel(i, i, i, 136);
    const auto image = decoded(head(c.resolution) + texels);
    ASSERT_TRUE(image.has_value()) << c.resolution << image.error().message();
    EXPECT_EQ(image->width(), 3);
    EXPECT_EQ(image->at(c.first[0], c.first[1])[0], 2.0f) << c.resolution;
    EXPECT_EQ(image->at(c.second[0], c.second[1])[0], 3.0f) << c.resolution;
  }
}

TEST(RadianceHdr, undoes_exposure_and_colour_correction) {
  const auto image = decoded(head("-Y 1 +X 1", "EXPOSURE=2.0\nEXPOSURE= 4\nCOLORCORR= 1 2 0.5\n# a=b\nVIEW= -vtv\n") +
                             texel(16, 16, 16, 136));
  ASSERT_TRUE(image.has_value()) << image.error().message();
  EXPECT_EQ(image->at(0, 0)[0], 2.0f);
  EXPECT_EQ(image->at(0, 0)[1], 1.0f);
  EXPECT_EQ(image->at(0, 0)[2], 4.0f);
}

TEST(RadianceHdr, clips_light_that_is_too_bright_to_sum) {
  const auto image = decoded(head("-Y 1 +X 1") + texel(255, 0, 0, 255));
  ASSERT_TRUE(image.has_value());
  EXPECT_EQ(image->at(0, 0)[0], 1e9f);
}

TEST(RadianceHdr, names_the_position_of_a_mistake) {
  const std::string new_row("\x02\x02\x00\x09", 4);
  for (const std::string& text :
       {std::string(), std::string("PNG"), head("-Y 1 +Y 1") + texel(2, 2, 2, 2), head("-Y 0 +X 1"),
        head("-Y 1 +X 1 2") + texel(2, 2, 2, 2), head("-Y 1 +X 1", "FORMAT=32-bit_rle_xyze\n") + texel(2, 2, 2, 2),
        head("-Y 1 +X 1", "EXPOSURE=0\n") + texel(2, 2, 2, 2), head("-Y 1 +X 1", "COLORCORR=1 2\n") + texel(2, 2, 2, 2),
        head("-Y 1 +X 2") + texel(1, 1, 1, 1), head("-Y 1 +X 2") + texel(3, 3, 3, 3) + texel(1, 1, 1, 9),
        head("-Y 1 +X 9") + new_row + run(10, 1) + run(9, 1) + run(9, 1) + run(9, 1),
        head("-Y 1 +X 9") + new_row + std::string("\0\0\0\0\0\0\0\0", 8),
        head("-Y 1 +X 10") + new_row + run(9, 1) + run(9, 1), head("-Y 99999999999999 +X 1"),
        head("-Y 4 +X 300000") + texel(2, 2, 2, 2)}) {
    const auto image = decoded(text);
    ASSERT_FALSE(image.has_value()) << text;
    EXPECT_EQ(image.error().code(), ErrorCode::kBadData);
    EXPECT_EQ(image.error().message().substr(0, 5), "byte ") << image.error().message();
    EXPECT_NE(image.error().message().find("again"), std::string::npos);
  }
  EXPECT_FALSE(decoded(head("-Y 10 +X 10") + std::string(400, '\2'), 99).has_value());
}

TEST(RadianceHdr, reads_photographs_and_refuses_truncated_ones) {
  // The means come from an independently written decoder.
  for (const auto& [name, known_mean] :
       {std::pair{"hdri/chinese_garden_1k.hdr", 0.4637809}, std::pair{"hdri/drachenfels_cellar_1k.hdr", 0.3200655}}) {
    CYCLORAMA_SHARED_DATA(path, name);
    const auto file = read_file(path, std::size_t{1} << 24);
    ASSERT_TRUE(file.has_value());
    const auto image = decode_radiance_hdr(*file, kLimitPx);
    ASSERT_TRUE(image.has_value()) << image.error().message();
    EXPECT_EQ(image->width(), 1024);
    EXPECT_EQ(image->height(), 512);
    double mean = 0.0;
    for (const float v : image->data()) mean += v;
    mean /= static_cast<double>(image->data().size());
    EXPECT_NEAR(mean, known_mean, 1e-5);
    for (std::size_t length = 0; length < file->size(); length += 99991) {
      EXPECT_FALSE(decode_radiance_hdr(std::span(*file).first(length), kLimitPx).has_value()) << length;
    }
    EXPECT_FALSE(decode_radiance_hdr(std::span(*file).first(file->size() - 1), kLimitPx).has_value());
  }
}

}  // namespace
}  // namespace cyclorama
