// SPDX-License-Identifier: Apache-2.0
#include "common/image/jpeg.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

namespace cyclorama {
namespace {

constexpr std::size_t kLimitPx = std::size_t{1} << 24;

/// Smooth, so that JPEG loses little.
RgbImage gradient(int width, int height) {
  RgbImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.at(x, y)[0] = static_cast<std::uint8_t>(255 * x / width);
      image.at(x, y)[1] = static_cast<std::uint8_t>(255 * y / height);
      image.at(x, y)[2] = 128;
    }
  }
  return image;
}

double mean_difference(const RgbImage& a, const RgbImage& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.data().size(); ++i) sum += std::abs(int{a.data()[i]} - int{b.data()[i]});
  return sum / static_cast<double>(a.data().size());
}

TEST(Jpeg, a_picture_of_any_size_survives_a_round_trip_approximately) {
  JpegEncoder encoder;
  JpegDecoder decoder;
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{17, 3}, std::pair{64, 48}, std::pair{333, 201}}) {
    for (const bool subsample : {false, true}) {
      const RgbImage image = gradient(width, height);
      const auto jpeg = encoder.encode(image, {.quality = 95, .subsample_chroma = subsample});
      ASSERT_TRUE(jpeg.has_value());
      const auto size = decoder.size_of(*jpeg);
      ASSERT_TRUE(size.has_value());
      EXPECT_EQ(size->width, width);
      EXPECT_EQ(size->height, height);
      const auto back = decoder.decode(*jpeg, kLimitPx);
      ASSERT_TRUE(back.has_value()) << back.error().message();
      EXPECT_LT(mean_difference(image, *back), subsample && height < 16 ? 20.0 : 4.0);
    }
  }
}

TEST(Jpeg, encodes_and_decodes_a_part_of_a_picture_in_place) {
  const RgbImage image = gradient(64, 64);
  JpegEncoder encoder;
  const auto jpeg = encoder.encode(image.at(16, 16), 32, 32, image.row_values(), {.quality = 95});
  ASSERT_TRUE(jpeg.has_value());
  RgbImage whole(64, 64);
  JpegDecoder decoder;
  ASSERT_TRUE(decoder.decode_into(*jpeg, whole.at(16, 16), 32, 32, whole.row_values()).has_value());
  EXPECT_NEAR(whole.at(30, 40)[0], image.at(30, 40)[0], 12);
  EXPECT_EQ(whole.at(15, 20)[0], 0);
  EXPECT_EQ(whole.at(48, 20)[0], 0);
  const Status wrong = decoder.decode_into(*jpeg, whole.at(0, 0), 32, 31, whole.row_values());
  ASSERT_FALSE(wrong.has_value());
  EXPECT_EQ(wrong.error().code(), ErrorCode::kBadData);
}

TEST(Jpeg, planes_agree_with_the_picture_for_any_size) {
  JpegEncoder encoder;
  JpegDecoder decoder;
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{17, 3}, std::pair{64, 48}, std::pair{333, 201}}) {
    for (const bool subsample : {false, true}) {
      const auto jpeg = encoder.encode(gradient(width, height), {.quality = 95, .subsample_chroma = subsample});
      ASSERT_TRUE(jpeg.has_value());
      const auto header = decoder.header_of(*jpeg);
      ASSERT_TRUE(header.has_value());
      EXPECT_EQ(header->has_half_chroma, subsample);
      PlanarPicture planes(width, height, subsample);
      ASSERT_TRUE(decoder.decode_into(*jpeg, &planes, {0, 0, width, height}).has_value());
      // Half chroma is repeated by the one decoder and interpolated by the other.
      const double allowed = !subsample ? 0.5 : height < 16 ? 20.0 : 2.0;
      EXPECT_LT(mean_difference(decoder.to_rgb(planes), *decoder.decode(*jpeg, kLimitPx)), allowed);
    }
  }
}

TEST(Jpeg, decodes_planes_in_place_and_changes_nothing_beside_them) {
  JpegEncoder encoder;
  JpegDecoder decoder;
  for (const bool subsample : {false, true}) {
    PlanarPicture planes(75, 51, subsample);  // The last tile ends at odd edges.
    const PixelRect place{48, 32, 27, 19};
    const auto jpeg = encoder.encode(RgbImage(27, 19, 200), {.quality = 95, .subsample_chroma = subsample});
    ASSERT_TRUE(decoder.decode_into(*jpeg, &planes, place).has_value());
    for (int y = 0; y < 51; ++y) {
      for (int x = 0; x < 75; ++x) {
        const bool inside = x >= place.x && y >= place.y;
        ASSERT_NEAR(*planes.luma().at(x, y), inside ? 200 : 0, inside ? 1 : 0) << x << " " << y;
      }
    }
    EXPECT_EQ(decoder.decode_into(*jpeg, &planes, {0, 0, 26, 18}).error().code(), ErrorCode::kBadData);
    PlanarPicture other(75, 51, !subsample);
    EXPECT_EQ(decoder.decode_into(*jpeg, &other, place).error().code(), ErrorCode::kBadData);
    const auto cut = std::span(*jpeg).first(jpeg->size() / 2);
    EXPECT_EQ(decoder.decode_into(cut, &planes, place).error().code(), ErrorCode::kBadData);
  }
}

TEST(Jpeg, planes_of_a_picture_agree_with_it) {
  const RgbImage picture = gradient(61, 33);
  EXPECT_LT(mean_difference(JpegDecoder().to_rgb(JpegEncoder().to_planar(picture)), picture), 0.7);
}

TEST(Jpeg, refuses_a_truncated_picture_and_never_returns_a_part) {
  JpegEncoder encoder;
  JpegDecoder decoder;
  const auto jpeg = encoder.encode(gradient(64, 48), {});
  ASSERT_TRUE(jpeg.has_value());
  for (std::size_t length = 0; length + 2 < jpeg->size(); ++length) {
    const auto part = decoder.decode(std::span(*jpeg).first(length), kLimitPx);
    ASSERT_FALSE(part.has_value()) << length;
    EXPECT_EQ(part.error().code(), ErrorCode::kBadData);
    EXPECT_TRUE(decoder.decode(*jpeg, kLimitPx).has_value()) << "after a failure at " << length;
  }
}

TEST(Jpeg, checks_limits_before_allocating_memory) {
  JpegEncoder encoder;
  const auto jpeg = encoder.encode(gradient(64, 48), {});
  ASSERT_TRUE(jpeg.has_value());
  JpegDecoder decoder;
  EXPECT_FALSE(decoder.decode(*jpeg, 64 * 48 - 1).has_value());
  EXPECT_FALSE(decoder.decode_grey(*jpeg, 64 * 48 - 1).has_value());
  EXPECT_TRUE(decoder.decode_grey(*jpeg, 64 * 48).has_value());
}

TEST(Jpeg, refuses_what_cannot_be_written) {
  JpegEncoder encoder;
  EXPECT_EQ(encoder.encode(RgbImage(), {}).error().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(encoder.encode(nullptr, 65501, 1, 0, {}).error().code(), ErrorCode::kInvalidArgument);
}

TEST(Jpeg, grey_is_the_luma_of_the_colour_picture) {
  JpegEncoder encoder;
  JpegDecoder decoder;
  const auto jpeg = encoder.encode(RgbImage(16, 16, 200), {.quality = 100});
  ASSERT_TRUE(jpeg.has_value());
  const auto grey = decoder.decode_grey(*jpeg, kLimitPx);
  ASSERT_TRUE(grey.has_value());
  EXPECT_NEAR(grey->at(8, 8)[0], 200, 1);
}

}  // namespace
}  // namespace cyclorama
