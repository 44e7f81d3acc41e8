// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/quality/flip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "common/image/colour.h"

namespace cyclorama::quality {
namespace {

using Colour3 = std::array<double, 3>;

RgbImage filled(const std::array<int, 3>& rgb, int width = 40, int height = 30) {
  RgbImage picture(width, height);
  for (std::size_t i = 0; i < picture.data().size(); ++i) picture.data()[i] = static_cast<std::uint8_t>(rgb[i % 3]);
  return picture;
}

RgbImage noise(unsigned seed, int width, int height) {
  std::mt19937 random(seed);
  RgbImage picture(width, height);
  for (std::uint8_t& code : picture.data()) code = static_cast<std::uint8_t>(random() & 0xff);
  return picture;
}

const std::array<int, 3> kBlack = {0, 0, 0};
const std::array<int, 3> kGrey = {118, 118, 118};
const std::array<int, 3> kWhite = {255, 255, 255};

double mean_of(const RgbImage& a, const RgbImage& b, double pixels_per_degree = kFlipPixelsPerDegree) {
  const auto result = flip(a, b, pixels_per_degree);
  EXPECT_TRUE(result.has_value());
  return result->mean;
}

/// An independent implementation of the paper for one pixel, in double, with full two-dimensional kernels.
class AtOnePixel {
 public:
  AtOnePixel(const RgbImage& picture, int x, int y, double ppd) : picture_(picture), x_(x), y_(y), ppd_(ppd) {}

  static Colour3 xyz(const Colour3& c) {
    const Colour3 xyz = {(10135552 * c[0] + 8788810 * c[1] + 4435075 * c[2]) / 24577794,
                         (2613072 * c[0] + 8788810 * c[1] + 887015 * c[2]) / 12288897,
                         (1425312 * c[0] + 8788810 * c[1] + 70074185 * c[2]) / 73733382};
    return {xyz[0] / 0.950428545, xyz[1], xyz[2] / 1.088900371};
  }
  static Colour3 hunt(const Colour3& rgb) {
    Colour3 t = xyz(rgb);
    for (double& v : t) v = v > 216.0 / 24389.0 ? std::cbrt(v) : (24389.0 / 27.0 * v + 16.0) / 116.0;
    const double l = 116 * t[1] - 16;
    return {l, 5 * l * (t[0] - t[1]), 2 * l * (t[1] - t[2])};
  }
  static double hyab(const Colour3& a, const Colour3& b) {
    return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
  }
  [[nodiscard]] Colour3 colour() const {
    const double pi = std::numbers::pi;
    const auto csf = [&](double a1, double b1, double a2, double b2) {
      return [=](double r2) {
        return a1 * std::sqrt(pi / b1) * std::exp(-pi * pi * r2 / b1) +
               a2 * std::sqrt(pi / b2) * std::exp(-pi * pi * r2 / b2);
      };
    };
    const double y = weighed(0, csf(1, 0.0047, 0, 1)) / 116 + 16.0 / 116;
    const double x = y + weighed(1, csf(1, 0.0053, 0, 1)) / 500;
    const double z = y - weighed(2, csf(34.1, 0.04, 13.5, 0.025)) / 200;
    const double cx = x * 0.950428545;
    const double cz = z * 1.088900371;
    Colour3 rgb = {3.241003275 * cx - 1.537398934 * y - 0.498615861 * cz,
                   -0.969224334 * cx + 1.875930071 * y + 0.041554224 * cz,
                   0.055639423 * cx - 0.204011202 * y + 1.057148933 * cz};
    for (double& v : rgb) v = std::clamp(v, 0.0, 1.0);
    return hunt(rgb);
  }
  [[nodiscard]] std::array<double, 2> features() const {
    const double sd = 0.5 * 0.082 * ppd_;
    const auto g = [sd](int u, int v) { return std::exp(-(u * u + v * v) / (2 * sd * sd)); };
    const auto edge = [&](int u, int v) { return -u * g(u, v); };
    const auto point = [&](int u, int v) { return (u * u / (sd * sd) - 1) * g(u, v); };
    return {detected(edge), detected(point)};
  }

 private:
  [[nodiscard]] double plane(int channel, int x, int y) const {
    const std::uint8_t* const code =
        picture_.at(std::clamp(x, 0, picture_.width() - 1), std::clamp(y, 0, picture_.height() - 1));
    const auto linear = [code](int i) {
      return static_cast<double>(srgb_to_linear(static_cast<float>(code[i]) / 255));
    };
    const Colour3 t = xyz({linear(0), linear(1), linear(2)});
    return channel == 0 ? 116 * t[1] - 16 : channel == 1 ? 500 * (t[0] - t[1]) : 200 * (t[1] - t[2]);
  }
  template <typename Weight>
  [[nodiscard]] double weighed(int channel, const Weight& weight) const {
    const int r = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * std::numbers::pi * std::numbers::pi)) * ppd_));
    double sum = 0, weights = 0;
    for (int v = -r; v <= r; ++v) {
      for (int u = -r; u <= r; ++u) {
        const double w = weight((u * u + v * v) / (ppd_ * ppd_));
        weights += w;
        sum += w * plane(channel, x_ + u, y_ + v);
      }
    }
    return sum / weights;
  }
  template <typename Detector>
  [[nodiscard]] double detected(const Detector& detector) const {
    const int r = static_cast<int>(std::ceil(3 * 0.5 * 0.082 * ppd_));
    double above = 0, below = 0, in_x[2] = {}, in_y[2] = {};
    for (int v = -r; v <= r; ++v) {
      for (int u = -r; u <= r; ++u) {
        const double w = detector(u, v);
        const bool negative = w < 0;
        (negative ? below : above) += std::abs(w);
        in_x[negative] += w * (plane(0, x_ + u, y_ + v) + 16) / 116;
        in_y[negative] += w * (plane(0, x_ + v, y_ + u) + 16) / 116;
      }
    }
    return std::hypot(in_x[0] / above + in_x[1] / below, in_y[0] / above + in_y[1] / below);
  }
  const RgbImage& picture_;
  int x_, y_;
  double ppd_;
};

double flip_at(const RgbImage& a, const RgbImage& b, int x, int y, double ppd) {
  const AtOnePixel at_a(a, x, y, ppd);
  const AtOnePixel at_b(b, x, y, ppd);
  const double max = std::pow(AtOnePixel::hyab(AtOnePixel::hunt({0, 1, 0}), AtOnePixel::hunt({0, 0, 1})), 0.7);
  const double power = std::pow(AtOnePixel::hyab(at_a.colour(), at_b.colour()), 0.7);
  const double colour = power < 0.4 * max ? 0.95 * power / (0.4 * max) : 0.95 + 0.05 * (power / max - 0.4) / 0.6;
  const auto fa = at_a.features();
  const auto fb = at_b.features();
  const double feature = std::max(std::abs(fa[0] - fb[0]), std::abs(fa[1] - fb[1]));
  return std::pow(colour, 1 - std::sqrt(feature / std::numbers::sqrt2));
}

TEST(Flip, is_zero_for_equal_pictures) {
  const auto result = flip(noise(1, 40, 30), noise(1, 40, 30));
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->mean, 0.0);
  EXPECT_EQ(*std::max_element(result->each.data().begin(), result->each.data().end()), 0.0f);
}

TEST(Flip, has_the_closed_form_for_black_and_white) {
  // Lightness differs by 100; green and blue, the pair with the largest distance, by 203.30: .95 + .05 (100^.7 /
  // 203.30^.7 - .4) / .6.
  EXPECT_NEAR(mean_of(filled(kBlack), filled(kWhite)), 0.96738, 1e-5);
}

TEST(Flip, has_its_maximum_for_green_and_blue) {
  EXPECT_NEAR(mean_of(filled({0, 255, 0}), filled({0, 0, 255})), 1.0, 1e-5);
}

TEST(Flip, agrees_with_the_paper_evaluated_pixel_by_pixel) {
  RgbImage a = noise(2, 32, 26);
  RgbImage b = noise(3, 32, 26);
  for (std::size_t i = 0; i < a.data().size(); ++i) {
    // Smooth in a and close to it in b, so that no colours are clipped.
    a.data()[i] = static_cast<std::uint8_t>(40 + 5 * (i / 3 % 32) + a.data()[i] / 8);
    b.data()[i] = static_cast<std::uint8_t>(a.data()[i] + b.data()[i] / 6);
  }
  for (const double ppd : {67.0206, 20.0}) {
    const auto result = flip(a, b, ppd);
    ASSERT_TRUE(result.has_value());
    for (const auto& [x, y] : {std::pair(0, 0), std::pair(31, 25), std::pair(16, 13), std::pair(3, 20)}) {
      EXPECT_NEAR(static_cast<double>(*result->each.at(x, y)), flip_at(a, b, x, y, ppd), 2e-4) << x << ", " << y;
    }
  }
}

TEST(Flip, is_symmetric) {
  const RgbImage a = noise(4, 30, 30);
  const RgbImage b = noise(5, 30, 30);
  EXPECT_DOUBLE_EQ(mean_of(a, b), mean_of(b, a));
}

TEST(Flip, grows_with_the_difference) {
  double before = 0.0;
  for (int code = 120; code < 256; code += 15) {
    const double mean = mean_of(filled(kGrey), filled({code, code, code}));
    EXPECT_GT(mean, before) << code;
    before = mean;
  }
}

TEST(Flip, fine_noise_is_less_visible_from_far_away) {
  RgbImage noisy = filled(kGrey, 64, 64);
  std::mt19937 random(6);
  for (std::uint8_t& code : noisy.data()) code = static_cast<std::uint8_t>(code - 12 + static_cast<int>(random() % 25));
  EXPECT_LT(mean_of(noisy, filled(kGrey, 64, 64), 200.0), 0.7 * mean_of(noisy, filled(kGrey, 64, 64), 20.0));
}

TEST(Flip, a_firefly_is_seen_where_it_is) {
  RgbImage firefly = filled(kGrey, 41, 41);
  std::fill_n(firefly.at(20, 20), 3, std::uint8_t{255});
  const auto result = flip(firefly, filled(kGrey, 41, 41));
  ASSERT_TRUE(result.has_value());
  EXPECT_GT(*result->each.at(20, 20), 0.3f);
  EXPECT_LT(*result->each.at(0, 0), 1e-3f);
}

TEST(Flip, a_lost_edge_is_seen_where_it_was) {
  RgbImage edge = filled(kGrey, 60, 40);
  for (int y = 0; y < 40; ++y) std::fill_n(edge.at(30, y), 90, std::uint8_t{150});
  RgbImage soft = edge;
  for (int y = 0; y < 40; ++y) {
    for (int x = 20; x < 40; ++x) std::fill_n(soft.at(x, y), 3, static_cast<std::uint8_t>(118 + 32 * (x - 20) / 20));
  }
  const auto result = flip(soft, edge);
  ASSERT_TRUE(result.has_value());
  EXPECT_GT(*result->each.at(30, 20), 0.1f);
  EXPECT_LT(*result->each.at(2, 20), 1e-4f);
}

TEST(Flip, is_never_outside_0_to_1) {
  RgbImage stripes = filled(kBlack, 40, 40);
  for (int y = 0; y < 40; ++y) std::fill_n(stripes.at(20, y), 60, std::uint8_t{255});
  for (const double ppd : {1.0, 67.0, 1000.0}) {
    for (const RgbImage& b : {filled(kBlack, 40, 40), filled(kWhite, 40, 40), noise(7, 40, 40)}) {
      const auto result = flip(stripes, b, ppd);
      ASSERT_TRUE(result.has_value());
      for (const float error : result->each.data()) ASSERT_TRUE(error >= 0.0f && error <= 1.0f) << error;
    }
  }
}

TEST(Flip, accepts_a_single_pixel) { EXPECT_GT(mean_of(filled(kBlack, 1, 1), filled(kWhite, 1, 1)), 0.9); }

TEST(Flip, refuses_different_sizes_and_impossible_viewing_conditions) {
  EXPECT_EQ(flip(filled(kGrey, 4, 5), filled(kGrey, 5, 4)).error().code(), ErrorCode::kInvalidArgument);
  for (const double ppd : {0.0, -67.0, 1e9, std::nan("")}) EXPECT_FALSE(flip(filled(kGrey), filled(kGrey), ppd));
}

}  // namespace
}  // namespace cyclorama::quality
