// SPDX-License-Identifier: Apache-2.0
#include "appliance/interchange/warp_pfm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "appliance/interchange/mask_png.h"
#include "common/image/pfm.h"
#include "tests/data_sets/generated_warps.h"

namespace cyclorama::interchange {
namespace {

using ::testing::HasSubstr;

class WarpPair : public ::testing::Test {
 protected:
  WarpPair() : folder_(std::filesystem::temp_directory_path() / ("warp_pair_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~WarpPair() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_;
};

TEST_F(WarpPair, survives_a_round_trip_including_unmapped_pixels) {
  GeneratedWarps made(1);
  WarpRegion region;
  region.id = "left";
  region.map = made.map(33, 20, true);
  region.width_px = 33;
  region.height_px = 20;
  region.alpha = MaskMap(33, 20, 1, 16);
  for (std::size_t i = 0; i < region.alpha->samples.size(); ++i) {
    region.alpha->samples[i] = static_cast<std::uint16_t>(97 * i);
  }
  ASSERT_TRUE(write_warp_pair(folder_ / "left.pfm", folder_ / "left.png", region).has_value());
  const auto back = read_warp_pair(folder_ / "left.pfm", folder_ / "left.png", WarpProfile::k2d);
  ASSERT_TRUE(back.has_value()) << back.error().message();
  EXPECT_EQ(*back, region);
  EXPECT_TRUE(std::isnan(back->map->at(0, 19)[0])) << "the lower left corner is not mapped";
}

TEST_F(WarpPair, converts_any_mask_to_linear_grey_of_16_bits) {
  WarpRegion region;
  region.id = "left";
  region.map = GeneratedWarps(2).map(2, 1, true);
  region.alpha = MaskMap(2, 1, 3, 8);
  region.alpha->samples = {255, 255, 255, 128, 128, 128};
  region.alpha->gamma = 2.0;
  ASSERT_TRUE(write_warp_pair(folder_ / "left.pfm", folder_ / "left.png", region).has_value());
  const auto back = read_warp_pair(folder_ / "left.pfm", folder_ / "left.png", WarpProfile::k2d);
  ASSERT_TRUE(back.has_value()) << back.error().message();
  EXPECT_EQ(back->alpha->bits, 16);
  EXPECT_EQ(back->alpha->channels, 1);
  EXPECT_EQ(back->alpha->samples[0], 65535);
  EXPECT_NEAR(back->alpha->light_at(1, 0), 0.25197, 1e-5);  // (128 / 255)^2
}

TEST_F(WarpPair, names_the_wrong_file_and_the_position) {
  WarpRegion region;
  region.map = GeneratedWarps(3).map(4, 4, true);
  ASSERT_TRUE(write_warp_pair(folder_ / "a.pfm", folder_ / "a.png", region).has_value());
  std::ofstream(folder_ / "a.png") << "no picture";
  const auto bad_mask = read_warp_pair(folder_ / "a.pfm", folder_ / "a.png", WarpProfile::k2d);
  ASSERT_FALSE(bad_mask.has_value());
  EXPECT_THAT(bad_mask.error().message(), HasSubstr("a.png': PNG"));
  std::filesystem::resize_file(folder_ / "a.pfm", 100);
  const auto cut = read_warp_pair(folder_ / "a.pfm", std::nullopt, WarpProfile::k2d);
  ASSERT_FALSE(cut.has_value());
  EXPECT_EQ(cut.error().code(), ErrorCode::kBadData);
  EXPECT_THAT(cut.error().message(), HasSubstr("a.pfm': byte "));
  EXPECT_EQ(read_warp_pair(folder_ / "no.pfm", std::nullopt, WarpProfile::k2d).error().code(), ErrorCode::kNotFound);
  EXPECT_EQ(write_warp_pair(folder_ / "b.pfm", folder_ / "b.png", WarpRegion()).error().code(),
            ErrorCode::kInvalidArgument);
}

TEST(WarpPfm, refuses_grey_infinite_and_oversized_maps) {
  const std::string grey("Pf\n1 1\n-1.0\n\0\0\0\0", 16);
  EXPECT_THAT(decode_warp_pfm(std::as_bytes(std::span(grey))).error().message(), HasSubstr("grey"));
  WarpMap map(3, 2);
  EXPECT_FALSE(decode_warp_pfm(encode_pfm(map), {.map_px = 5}).has_value());
  EXPECT_TRUE(decode_warp_pfm(encode_pfm(map), {.map_px = 6}).has_value());
  map.at(2, 1)[1] = std::numeric_limits<float>::infinity();
  WarpRegion region;
  region.id = "r";
  region.width_px = 3;
  region.height_px = 2;
  region.map = map;
  EXPECT_THAT(check(region, WarpProfile::k2d).error().message(), HasSubstr("column 2, row 1"));
}

TEST(MaskPng, reads_grey_and_colour_of_8_and_16_bits) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    MaskMap mask = GeneratedWarps(seed).mask(17, 9);
    mask.gamma = 1.0;
    const auto png = encode_mask_png(mask);
    ASSERT_TRUE(png.has_value());
    const auto back = decode_mask_png(*png, 17 * 9);
    ASSERT_TRUE(back.has_value()) << back.error().message();
    EXPECT_EQ(*back, mask) << seed;
    EXPECT_FALSE(decode_mask_png(*png, 17 * 9 - 1).has_value());
    for (std::size_t length = 0; length < png->size() - 4; length += 3) {  // The last four bytes are IEND's checksum.
      EXPECT_FALSE(decode_mask_png(std::span(*png).first(length), 1000).has_value()) << length;
    }
  }
}

}  // namespace
}  // namespace cyclorama::interchange
