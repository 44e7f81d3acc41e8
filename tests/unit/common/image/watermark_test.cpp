// SPDX-License-Identifier: Apache-2.0
#include "common/image/watermark.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "common/image/cropped.h"
#include "common/image/jpeg.h"
#include "common/image/watermark_detector.h"

namespace cyclorama {
namespace {

constexpr std::uint64_t kKey = 0x1d872b41c0ffee05u;
constexpr int kWidth = 960;
constexpr int kHeight = 544;

/// Soft shapes, hard edges and noise, as in a rendered picture.
RgbImage some_picture(int width = kWidth, int height = kHeight, unsigned noise_seed = 7) {
  std::mt19937 random(noise_seed);
  std::normal_distribution<double> noise(0.0, 4.0);
  RgbImage picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double soft = 120.0 + 60.0 * std::sin(0.011 * x) * std::cos(0.017 * y);
      const double edge = (x / 90 + y / 70) % 2 == 0 ? 25.0 : -25.0;
      for (int c = 0; c < 3; ++c) {
        picture.at(x, y)[c] = static_cast<std::uint8_t>(std::clamp(soft + edge + 8.0 * c + noise(random), 0.0, 255.0));
      }
    }
  }
  return picture;
}

RgbImage marked(RgbImage picture, std::uint64_t key = kKey) {
  add_watermark(key, {0, 0, picture.width(), picture.height()}, &picture);
  return picture;
}

RgbImage through_jpeg(const RgbImage& picture, int quality) {
  const auto jpeg = JpegEncoder().encode(picture, {quality, true});
  EXPECT_TRUE(jpeg.has_value());
  return *JpegDecoder().decode(*jpeg, std::size_t{1} << 24);
}

RgbImage halved(const RgbImage& picture) {
  RgbImage half(picture.width() / 2, picture.height() / 2);
  for (int y = 0; y < half.height(); ++y) {
    for (int x = 0; x < half.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        half.at(x, y)[c] =
            static_cast<std::uint8_t>((picture.at(2 * x, 2 * y)[c] + picture.at(2 * x + 1, 2 * y)[c] +
                                       picture.at(2 * x, 2 * y + 1)[c] + picture.at(2 * x + 1, 2 * y + 1)[c] + 2) /
                                      4);
      }
    }
  }
  return half;
}

TEST(Watermark, is_independent_of_the_division_into_tiles) {
  const RgbImage plain = some_picture();
  const RgbImage whole = marked(plain);
  for (const int step : {16, 48, 256, 101}) {  // 101 is not a multiple of the block size.
    for (int y = 0; y < kHeight; y += step) {
      for (int x = 0; x < kWidth; x += step) {
        const PixelRect rect{x, y, std::min(step, kWidth - x), std::min(step, kHeight - y)};
        RgbImage part = cropped(plain, rect);
        add_watermark(kKey, rect, &part);
        ASSERT_EQ(part, cropped(whole, rect)) << step << ": " << x << ", " << y;
      }
    }
  }
}

TEST(Watermark, changes_nothing_without_a_key) { EXPECT_EQ(marked(some_picture(), 0), some_picture()); }

TEST(Watermark, changes_one_cell_in_eight_by_one_code_value) {
  const RgbImage grey(512, 512, 128);
  const RgbImage picture = marked(grey);
  std::int64_t changed = 0;
  std::int64_t sum = 0;
  for (const std::uint8_t value : picture.data()) {
    ASSERT_LE(std::abs(value - 128), 1);
    changed += value != 128 ? 1 : 0;
    sum += value - 128;
  }
  const auto count = static_cast<double>(picture.data().size());
  EXPECT_NEAR(static_cast<double>(changed) / count, 0.125, 0.02);
  EXPECT_NEAR(static_cast<double>(sum) / count, 0.0, 0.05);  // The picture's mean brightness is unchanged.
}

TEST(Watermark, does_not_change_black_and_white) {
  for (const int value : {0, 3, 7, 248, 255}) {
    const RgbImage flat(256, 256, static_cast<std::uint8_t>(value));
    EXPECT_EQ(marked(flat), flat) << value;
  }
}

TEST(Watermark, is_detected_with_its_key_only) {
  const RgbImage picture = marked(some_picture());
  EXPECT_GT(watermark_score(kKey, picture), 15.0);
  EXPECT_LT(std::abs(watermark_score(kKey, some_picture())), 5.0);
  const WatermarkDetector detector(picture);
  double sum = 0.0;
  double squares = 0.0;
  constexpr int kKeys = 1000;
  for (std::uint64_t key = 1; key <= kKeys; ++key) {
    const double score = detector.score(key);
    EXPECT_LT(std::abs(score), 5.0) << key;
    sum += score;
    squares += score * score;
  }
  // For other keys the score is normally distributed with deviation 1; tolerance of three deviations of each estimate.
  EXPECT_NEAR(sum / kKeys, 0.0, 3.0 / std::sqrt(kKeys));
  EXPECT_NEAR(squares / kKeys, 1.0, 3.0 * std::sqrt(2.0 / kKeys));
}

TEST(Watermark, is_unrelated_for_keys_that_differ_in_one_bit) {
  const WatermarkDetector detector(marked(some_picture()));
  for (int bit = 0; bit < 64; ++bit) {
    EXPECT_LT(std::abs(detector.score(kKey ^ std::uint64_t{1} << bit)), 5.0) << bit;
  }
}

TEST(Watermark, survives_jpeg) {
  const RgbImage picture = marked(some_picture());
  for (const int quality : {95, 85, 75}) {
    EXPECT_GT(watermark_score(kKey, through_jpeg(picture, quality)), kWatermarkCertain) << quality;
  }
}

RgbImage mean_of(const std::vector<RgbImage>& pictures) {
  RgbImage mean(pictures.front().width(), pictures.front().height());
  for (std::size_t i = 0; i < mean.data().size(); ++i) {
    double sum = 0.0;
    for (const RgbImage& picture : pictures) sum += picture.data()[i];
    mean.data()[i] = static_cast<std::uint8_t>(std::lround(sum / static_cast<double>(pictures.size())));
  }
  return mean;
}

/// Returns the scores of three museums in the mean of their pictures of one view. `noise_seeds`: the noise of each.
std::vector<double> scores_of_collusion(const std::array<unsigned, 3>& noise_seeds) {
  std::vector<RgbImage> pictures;
  for (const unsigned museum : {0u, 1u, 2u}) {
    pictures.push_back(through_jpeg(marked(some_picture(kWidth, kHeight, noise_seeds[museum]), kKey + museum), 85));
  }
  const WatermarkDetector detector(mean_of(pictures));
  for (std::uint64_t key = 1; key <= 1000; ++key) EXPECT_LT(std::abs(detector.score(key)), 5.0) << key;
  return {detector.score(kKey), detector.score(kKey + 1), detector.score(kKey + 2)};
}

TEST(Watermark, names_each_of_three_museums_that_average_their_pictures_of_one_view) {
  for (const double score : scores_of_collusion({1, 2, 3})) EXPECT_GT(score, kWatermarkCertain);
}

TEST(Watermark, points_at_three_museums_that_average_pictures_of_the_same_noise) {
  // Rounding removes a part of the mean mark. Where the position is known, no other key of a million has such a score.
  for (const double score : scores_of_collusion({7, 7, 7})) EXPECT_GT(score, 6.0);
}

TEST(Watermark, survives_averaging_many_frames_of_one_museum) {
  std::vector<RgbImage> frames;
  for (unsigned frame = 0; frame < 16; ++frame) {
    frames.push_back(through_jpeg(marked(some_picture(kWidth, kHeight, frame)), 85));
  }
  EXPECT_GT(watermark_score(kKey, mean_of(frames)), watermark_score(kKey, frames.front()))
      << "the mark is the same in all, and their noise is not";
}

TEST(Watermark, survives_cropping_at_any_position) {
  const RgbImage picture = through_jpeg(marked(some_picture()), 85);
  const RgbImage part = cropped(picture, {333, 90, 500, 401});
  const WatermarkFind find = WatermarkDetector(part).search(kKey);
  EXPECT_GT(find.score, kWatermarkCertain);
  EXPECT_EQ(find.x_px, 333 % 256);
  EXPECT_EQ(find.y_px, 90);
  EXPECT_LT(WatermarkDetector(part).search(kKey + 1).score, 6.0);
}

TEST(Watermark, survives_scaling_to_half_the_size) {
  const RgbImage picture = through_jpeg(halved(marked(some_picture())), 85);
  EXPECT_GT(WatermarkDetector(picture, kWatermarkCellPx / 2).score(kKey), kWatermarkCertain);
}

TEST(Watermark, has_no_score_for_pictures_smaller_than_a_cell) {
  EXPECT_EQ(watermark_score(kKey, RgbImage(3, 2, 9)), 0.0);
  EXPECT_EQ(WatermarkDetector(RgbImage{}).search(kKey).score, 0.0);
}

}  // namespace
}  // namespace cyclorama
