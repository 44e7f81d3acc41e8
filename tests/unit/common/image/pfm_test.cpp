// SPDX-License-Identifier: Apache-2.0
#include "common/image/pfm.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>

namespace cyclorama {
namespace {

constexpr std::size_t kLimitPx = 1 << 20;

RadianceImage noise(int width, int height) {
  RadianceImage image(width, height);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> value(-1.0f, 1e6f);
  for (float& v : image.data()) v = value(random);
  return image;
}

std::vector<std::byte> bytes_of(const std::string& text) {
  const auto* const begin = reinterpret_cast<const std::byte*>(text.data());
  return {begin, begin + text.size()};
}

TEST(Pfm, survives_a_round_trip_bit_by_bit) {
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{3, 200}, std::pair{257, 31}}) {
    const RadianceImage image = noise(width, height);
    const auto back = decode_pfm(encode_pfm(image), kLimitPx);
    ASSERT_TRUE(back.has_value()) << back.error().message();
    EXPECT_EQ(*back, image);
  }
}

TEST(Pfm, keeps_values_that_are_not_finite) {
  RadianceImage image(2, 1);
  image.at(0, 0)[1] = std::numeric_limits<float>::quiet_NaN();
  image.at(1, 0)[2] = -std::numeric_limits<float>::infinity();
  const auto back = decode_pfm(encode_pfm(image), kLimitPx);
  ASSERT_TRUE(back.has_value());
  EXPECT_TRUE(std::isnan(back->at(0, 0)[1]));
  EXPECT_EQ(back->at(1, 0)[2], -std::numeric_limits<float>::infinity());
}

TEST(Pfm, stores_the_lowest_row_first) {
  const auto image = decode_pfm(encode_pfm(noise(4, 3)), kLimitPx);
  const std::vector<std::byte> pfm = encode_pfm(*image);
  float first = 0.0f;
  std::memcpy(&first, pfm.data() + pfm.size() - 4 * 3 * 3 * sizeof(float), sizeof(first));
  EXPECT_EQ(first, image->at(0, 2)[0]);
}

TEST(Pfm, reads_big_endian_and_grey_files) {
  const std::string one("\x3f\x80\x00\x00", 4);
  const std::string two("\x40\x00\x00\x00", 4);
  const auto grey = decode_pfm(bytes_of("Pf\n2 1\n1.0\n" + one + two), kLimitPx);
  ASSERT_TRUE(grey.has_value()) << grey.error().message();
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(grey->at(0, 0)[c], 1.0f);
    EXPECT_EQ(grey->at(1, 0)[c], 2.0f);
  }
  const auto colour = decode_pfm(bytes_of("PF 1 1 1\n" + one + two + one), kLimitPx);
  ASSERT_TRUE(colour.has_value()) << colour.error().message();
  EXPECT_EQ(colour->at(0, 0)[1], 2.0f);
}

TEST(Pfm, refuses_invalid_files_naming_the_position) {
  const std::vector<std::byte> pfm = encode_pfm(noise(7, 5));
  for (std::size_t length = 0; length < pfm.size(); ++length) {
    const auto part = decode_pfm(std::span(pfm).first(length), kLimitPx);
    ASSERT_FALSE(part.has_value()) << length;
    EXPECT_EQ(part.error().code(), ErrorCode::kBadData);
    EXPECT_EQ(part.error().message().substr(0, 5), "byte ") << part.error().message();
  }
  std::vector<std::byte> longer = pfm;
  longer.push_back({});
  EXPECT_FALSE(decode_pfm(longer, kLimitPx).has_value());
  EXPECT_FALSE(decode_pfm(pfm, 34).has_value());
  EXPECT_TRUE(decode_pfm(pfm, 35).has_value());
  for (const char* const text : {"", "P6\n1 1\n255\n", "PF\n-1 1\n-1\n", "PF\n2147483647 2147483647\n-1\n",
                                 "PF\n1 1\n0\n", "PF\n1 1\nnan\n", "PF\n99999999999999999999 1\n1\n", "PF\n1 1\n"}) {
    EXPECT_FALSE(decode_pfm(bytes_of(text), kLimitPx).has_value()) << text;
  }
}

TEST(Pfm, reads_a_written_file_and_names_it_in_errors) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("pfm_test_" + std::to_string(::getpid()) + ".pfm");
  const RadianceImage image = noise(8, 8);
  ASSERT_TRUE(write_pfm(path, image).has_value());
  const auto back = read_pfm(path, 64);
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(*back, image);
  const auto too_large = read_pfm(path, 63);
  ASSERT_FALSE(too_large.has_value());
  EXPECT_NE(too_large.error().message().find(path.string()), std::string::npos);
  std::filesystem::remove(path);
  EXPECT_EQ(read_pfm(path, 64).error().code(), ErrorCode::kNotFound);
  EXPECT_EQ(write_pfm(path, RadianceImage()).error().code(), ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace cyclorama
