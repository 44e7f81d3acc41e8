// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/true_sensor.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cyclorama::simulated {
namespace {

TrueCamera linear_camera() {
  TrueCamera camera;
  camera.bits = 16;
  camera.full_well_e = 20000.0;
  camera.pedestal = 0.1;
  return camera;
}

struct Moments {
  double mean = 0.0;
  double variance = 0.0;
};

/// Returns the moments of many readings of the same charge, in electrons.
Moments read(const TrueCamera& camera, float electrons, int rows) {
  const TrueSensor sensor(camera);
  constexpr std::size_t kWidth = 1000;
  const std::vector<float> row(kWidth, electrons);
  std::vector<std::uint16_t> codes(kWidth);
  const double per_code = camera.full_well_e / ((1 << camera.bits) - 1);
  double sum = 0.0;
  double squares = 0.0;
  for (int y = 0; y < rows; ++y) {
    sensor.read_row(row, mixed(static_cast<std::uint64_t>(y)), codes.data(), 1);
    for (const std::uint16_t code : codes) {
      const double value = code * per_code - camera.pedestal * camera.full_well_e;
      sum += value;
      squares += value * value;
    }
  }
  const double n = static_cast<double>(kWidth) * rows;
  return {sum / n, squares / n - sum / n * (sum / n)};
}

// z-tests against the closed form: variance = electrons (shot) + read^2 + 1/12 for rounding.
TEST(TrueSensor, noise_has_the_mean_and_variance_of_shot_and_read_noise) {
  TrueCamera camera = linear_camera();
  camera.has_shot_noise = true;
  camera.read_noise_e = 12.0;
  constexpr int kRows = 400;
  const double n = 1000.0 * kRows;
  const double per_code = camera.full_well_e / 65535.0;
  for (const float electrons : {0.0f, 100.0f, 2500.0f, 12000.0f}) {
    const double variance = static_cast<double>(electrons) + 144.0 + per_code * per_code / 12.0;
    const Moments got = read(camera, electrons, kRows);
    EXPECT_LT(std::abs(got.mean - static_cast<double>(electrons)) / std::sqrt(variance / n), 4.5);
    EXPECT_LT(std::abs(got.variance - variance) / (variance * std::sqrt(2.0 / n)), 4.5);
  }
}

TEST(TrueSensor, without_noise_it_rounds_the_response) {
  for (const int bits : {8, 10, 12, 16}) {
    TrueCamera camera = linear_camera();
    camera.bits = bits;
    camera.pedestal = 0.0;
    camera.response = {0.7, 0.05};
    const TrueSensor sensor(camera);
    std::vector<float> row;
    for (int i = 0; i <= 1000; ++i) row.push_back(22.0f * static_cast<float>(i));
    std::vector<std::uint16_t> codes(row.size());
    sensor.read_row(row, 1, codes.data(), 1);
    for (std::size_t i = 0; i < row.size(); ++i) {
      const double x = std::min(static_cast<double>(row[i]) / 20000.0, 1.0);
      const double expected = (std::pow(x, 0.7) + 0.05 * x * (1 - x) * (1 - 2 * x)) * ((1 << bits) - 1);
      EXPECT_NEAR(codes[i], expected, bits == 16 ? 8.0 : 0.75);
      EXPECT_NEAR(sensor.expected_code(static_cast<double>(row[i])), expected, 1e-2);
    }
    EXPECT_EQ(codes.back(), (1 << bits) - 1);  // Clipped.
  }
}

TEST(TrueSensor, equal_streams_have_equal_noise_and_others_differ) {
  TrueCamera camera = linear_camera();
  camera.read_noise_e = 50.0;
  const TrueSensor sensor(camera);
  const std::vector<float> row(64, 5000.0f);
  std::vector<std::uint16_t> a(64);
  std::vector<std::uint16_t> b(64);
  sensor.read_row(row, 7, a.data(), 1);
  sensor.read_row(row, 7, b.data(), 1);
  EXPECT_EQ(a, b);
  sensor.read_row(row, 8, b.data(), 1);
  EXPECT_NE(a, b);
}

// Correlated noise of neighbours would act as blur.
TEST(TrueSensor, noise_is_independent_between_neighbours) {
  TrueCamera camera = linear_camera();
  camera.read_noise_e = 200.0;
  const TrueSensor sensor(camera);
  constexpr std::size_t kCount = 200000;
  const std::vector<float> row(kCount, 9000.0f);
  std::vector<std::uint16_t> codes(kCount);
  sensor.read_row(row, 3, codes.data(), 1);
  double mean = 0.0;
  for (const auto code : codes) mean += static_cast<double>(code) / kCount;
  for (const std::size_t lag : {1u, 2u, 3u, 4u, 5u, 8u}) {
    double together = 0.0;
    double alone = 0.0;
    for (std::size_t i = 0; i + lag < kCount; ++i) {
      together += (codes[i] - mean) * (codes[i + lag] - mean);
      alone += (codes[i] - mean) * (codes[i] - mean);
    }
    EXPECT_LT(std::abs(together / alone) * std::sqrt(static_cast<double>(kCount)), 4.5) << "lag " << lag;
  }
}

TEST(TrueResponse, stays_between_dark_and_bright) {
  const TrueResponse odd{2.2, 0.3, 0.9, 0.5};
  for (double x = -1.0; x < 2.0; x += 0.01) {
    EXPECT_GE(odd.at(x), 0.0);
    EXPECT_LE(odd.at(x), 1.0);
  }
  EXPECT_EQ(odd.at(std::nan("")), 0.0);
  EXPECT_LT(odd.at(0.85), odd.at(0.75));  // A flaw that a calibration must report.
}

}  // namespace
}  // namespace cyclorama::simulated
