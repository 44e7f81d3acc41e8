// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/quality/code_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace cyclorama::quality {
namespace {

RgbImage constant(int code, int width = 24, int height = 20) {
  return {width, height, static_cast<std::uint8_t>(code)};
}

RgbImage noise(unsigned seed, int width = 24, int height = 20) {
  std::mt19937 random(seed);
  RgbImage picture(width, height);
  for (std::uint8_t& code : picture.data()) code = static_cast<std::uint8_t>(random() & 0xff);
  return picture;
}

/// Equation 13 of the paper, window by window and without filters: an independent implementation.
double ssim_by_windows(const RgbImage& a, const RgbImage& b) {
  const auto luma = [](const RgbImage& p, int x, int y) {
    const std::uint8_t* rgb = p.at(x, y);
    return 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2];
  };
  double sum = 0.0;
  int windows = 0;
  for (int y = 5; y < a.height() - 5; ++y) {
    for (int x = 5; x < a.width() - 5; ++x, ++windows) {
      double w = 0, ma = 0, mb = 0, va = 0, vb = 0, cov = 0;
      const auto each = [&](const auto& use) {
        for (int v = -5; v <= 5; ++v) {
          for (int u = -5; u <= 5; ++u) {
            use(std::exp(-(u * u + v * v) / 4.5), luma(a, x + u, y + v), luma(b, x + u, y + v));
          }
        }
      };
      each([&](double g, double p, double q) { w += g, ma += g * p, mb += g * q; });
      ma /= w, mb /= w;
      each([&](double g, double p, double q) {
        va += g / w * (p - ma) * (p - ma), vb += g / w * (q - mb) * (q - mb), cov += g / w * (p - ma) * (q - mb);
      });
      sum += (2 * ma * mb + 6.5025) * (2 * cov + 58.5225) / ((ma * ma + mb * mb + 6.5025) * (va + vb + 58.5225));
    }
  }
  return sum / windows;
}

TEST(Psnr, is_infinite_for_equal_pictures_and_zero_between_black_and_white) {
  EXPECT_TRUE(std::isinf(*psnr(noise(1), noise(1))));
  EXPECT_DOUBLE_EQ(*psnr(constant(0), constant(255)), 0.0);
}

TEST(Psnr, is_48_13_decibels_for_one_code_value) {
  EXPECT_NEAR(*psnr(constant(100), constant(101)), 48.1308036, 1e-6);
  EXPECT_NEAR(*psnr(constant(110), constant(100)), 28.1308036, 1e-6);
}

TEST(Ssim, is_one_for_equal_pictures_only) {
  EXPECT_NEAR(*ssim(noise(1), noise(1)), 1.0, 1e-12);
  EXPECT_NEAR(*ssim(constant(0), constant(0)), 1.0, 1e-12);
  EXPECT_LT(*ssim(noise(1), noise(2)), 0.1);
}

TEST(Ssim, is_the_luminance_term_for_constant_pictures) {
  EXPECT_NEAR(*ssim(constant(100), constant(150)), (2.0 * 100 * 150 + 6.5025) / (100.0 * 100 + 150 * 150 + 6.5025),
              1e-9);
  EXPECT_NEAR(*ssim(constant(0), constant(255)), 6.5025 / (255.0 * 255.0 + 6.5025), 1e-9);
}

TEST(Ssim, agrees_with_windows_evaluated_one_by_one) {
  RgbImage near = noise(3);
  for (std::uint8_t& code : near.data()) code = static_cast<std::uint8_t>(code / 2 + 60);
  EXPECT_NEAR(*ssim(near, noise(3)), ssim_by_windows(near, noise(3)), 1e-9);
  EXPECT_NEAR(*ssim(noise(4, 11, 11), noise(5, 11, 11)), ssim_by_windows(noise(4, 11, 11), noise(5, 11, 11)), 1e-9);
}

TEST(Ssim, is_negative_for_a_negative) {
  RgbImage negative = noise(6);
  for (std::uint8_t& code : negative.data()) code = static_cast<std::uint8_t>(255 - code);
  EXPECT_LT(*ssim(negative, noise(6)), -0.5);
}

TEST(CodeError, refuses_pictures_of_different_sizes) {
  EXPECT_EQ(psnr(constant(0, 24, 20), constant(0, 20, 24)).error().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(ssim(constant(0, 24, 20), constant(0, 20, 24)).error().code(), ErrorCode::kInvalidArgument);
  EXPECT_FALSE(psnr({}, {}));
}

TEST(Ssim, refuses_a_picture_smaller_than_its_window) {
  const auto result = ssim(constant(0, 10, 20), constant(0, 10, 20));
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message(), testing::HasSubstr("11x11"));
}

}  // namespace
}  // namespace cyclorama::quality
