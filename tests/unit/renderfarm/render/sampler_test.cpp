// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace cyclorama::render {
namespace {

std::vector<Vec2> points_of_pixels(int side, int samples, std::uint32_t dimension, std::uint64_t seed, int x0 = 8) {
  std::vector<Vec2> points;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      for (int s = 0; s < samples; ++s) points.push_back(SampleSequence(seed, x0 + x, y, s, samples).pair(dimension));
    }
  }
  return points;
}

/// Every elementary interval of area 1/n contains exactly one of n points: a (0, m, 2)-net.
void expect_net(const std::vector<Vec2>& points) {
  const int n = static_cast<int>(points.size());
  for (int columns = 1; columns <= n; columns *= 2) {
    const int rows = n / columns;
    std::set<int> hit;
    for (const Vec2& p : points) {
      hit.insert(static_cast<int>(p.x() * static_cast<float>(columns)) * rows +
                 static_cast<int>(p.y() * static_cast<float>(rows)));
    }
    EXPECT_EQ(hit.size(), points.size()) << columns << " columns of " << n;
  }
}

TEST(SampleSequence, the_samples_of_a_pixel_are_a_net_in_every_dimension) {
  for (std::uint32_t dimension = 0; dimension < 6; ++dimension) {
    for (const int samples : {1, 2, 4, 16, 64, 256}) expect_net(points_of_pixels(1, samples, dimension, 5));
  }
}

TEST(SampleSequence, the_samples_of_neighbouring_pixels_are_a_net_together) {
  expect_net(points_of_pixels(2, 1, 0, 1));
  expect_net(points_of_pixels(4, 1, 1, 2));
  expect_net(points_of_pixels(2, 4, 2, 3));
  expect_net(points_of_pixels(8, 4, 3, 4));
}

TEST(SampleSequence, stays_inside_the_unit_square_for_all_pixels_and_samples) {
  for (const int x : {0, 1, 16383}) {
    for (const int s : {0, 1, 4095, 65535}) {
      const SampleSequence sequence(~0ull, x, 16383, s, 65536);
      for (std::uint32_t d = 0; d < 100; ++d) {
        const Vec2 p = sequence.pair(d);
        ASSERT_GE(p.minCoeff(), 0.0f);
        ASSERT_LT(p.maxCoeff(), 1.0f);
      }
    }
  }
}

TEST(SampleSequence, differs_between_pixels_dimensions_and_seeds) {
  std::set<std::pair<float, float>> seen;
  int count = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    for (int x = 0; x < 16; ++x) {
      for (std::uint32_t d = 0; d < 8; ++d, ++count) {
        const Vec2 p = SampleSequence(seed << 31, x, 3, 0, 1).pair(d);
        seen.insert({p.x(), p.y()});
      }
    }
  }
  EXPECT_EQ(static_cast<int>(seen.size()), count);
}

TEST(SampleSequence, two_dimensions_are_independent_of_each_other) {
  double product = 0.0;
  constexpr int kCount = 4096;
  for (int s = 0; s < kCount; ++s) {
    const SampleSequence sequence(7, 1, 2, s, kCount);
    product += (static_cast<double>(sequence.pair(0).x()) - 0.5) * (static_cast<double>(sequence.pair(1).x()) - 0.5);
  }
  EXPECT_LT(std::abs(product / kCount) * 12.0, 4.0 / std::sqrt(kCount));  // Correlation, within four sigma.
}

TEST(SampleSequence, integrates_better_than_independent_numbers) {
  // Integral of a disc's indicator; independent samples would have an rms error of 0.41 / sqrt(n) = 0.0064.
  constexpr int kCount = 4096;
  double error2 = 0.0;
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    int inside = 0;
    for (int s = 0; s < kCount; ++s) inside += SampleSequence(seed, 0, 0, s, kCount).pair(0).norm() < 1.0f ? 1 : 0;
    error2 += std::pow(inside / static_cast<double>(kCount) - 0.785398163, 2.0);
  }
  EXPECT_LT(std::sqrt(error2 / 16), 0.002);
}

}  // namespace
}  // namespace cyclorama::render
