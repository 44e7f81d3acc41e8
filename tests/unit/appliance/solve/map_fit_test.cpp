// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/map_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <random>

#include "appliance/solve/selected_inverse.h"
#include "tests/data_sets/generated_room.h"

namespace cyclorama::solve {
namespace {

/// Directions of a projector whose map is smoothly curved.
Eigen::Vector3d bent(const Eigen::Vector2d& p) {
  const double a = 0.3 + 4.1e-4 * (p.x() - 960.0) + 3e-8 * (p.x() - 960.0) * (p.y() - 540.0);
  const double t = -4.0e-4 * (p.y() - 540.0) + 2e-8 * (p.x() - 960.0) * (p.x() - 960.0);
  return Eigen::Vector3d(std::sin(a), t, -std::cos(a)).normalized();
}

std::vector<MapSample> samples_of(double noise_px, double outliers, unsigned seed, int step_px = 16) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<MapSample> samples;
  for (int y = step_px / 2; y < 1080; y += step_px) {
    for (int x = step_px / 2; x < 1920; x += step_px) {
      const Eigen::Vector2d at(x, y);
      const Eigen::Vector2d told = at + noise_px * Eigen::Vector2d(normal(random), normal(random));
      Eigen::Vector3d d = bent(at);
      if (unit(random) < outliers) d = bent({1920.0 * unit(random), 1080.0 * unit(random)});
      samples.push_back({told, d, std::max(noise_px, 0.01)});
    }
  }
  return samples;
}

double worst_error_px(const calibration::MeasuredMap& map, double margin_px) {
  double worst = 0.0;
  for (double y = margin_px; y < 1080.0 - margin_px; y += 13.0) {
    for (double x = margin_px; x < 1920.0 - margin_px; x += 13.0) {
      const auto d = map.direction_at({x, y});
      if (!d) return 1e9;
      worst = std::max(worst, (*d - bent({x, y})).norm() / 4.05e-4);
    }
  }
  return worst;
}

TEST(MeasuredMap, is_exact_without_noise) {
  const auto map = fit_measured_map(1920, 1080, samples_of(0.0, 0.0, 1));
  ASSERT_TRUE(map) << map.error().message();
  EXPECT_LE(worst_error_px(*map, 0.0), 0.05);
}

TEST(MeasuredMap, averages_noise_and_rejects_gross_errors) {
  const auto map = fit_measured_map(1920, 1080, samples_of(0.2, 0.01, 2, 8));
  ASSERT_TRUE(map) << map.error().message();
  EXPECT_LE(worst_error_px(*map, 24.0), 0.5);
  EXPECT_NEAR(map->heldout_rms_px, 0.2, 0.06);
}

TEST(MeasuredMap, fills_gaps_and_states_its_uncertainty) {
  auto samples = samples_of(0.05, 0.0, 3);
  std::erase_if(samples, [](const MapSample& s) {
    return std::abs(s.projector_px.x() - 700.0) < 80.0 && std::abs(s.projector_px.y() - 500.0) < 80.0;
  });
  const auto map = fit_measured_map(1920, 1080, samples);
  ASSERT_TRUE(map) << map.error().message();
  EXPECT_GT(map->sigma_at({700.0, 500.0}), 1.5 * map->sigma_at({1200.0, 500.0}));
  const auto filled = map->direction_at({700.0, 500.0});
  ASSERT_TRUE(filled);
  const double error_px = (*filled - bent({700.0, 500.0})).norm() / 4.05e-4;
  EXPECT_LE(error_px, 4.0 * map->sigma_at({700.0, 500.0}) + 0.05);
}

TEST(MeasuredMap, is_empty_far_from_observations) {
  auto samples = samples_of(0.05, 0.0, 4);
  std::erase_if(samples, [](const MapSample& s) { return s.projector_px.x() > 600.0; });
  const auto map = fit_measured_map(1920, 1080, samples);
  ASSERT_TRUE(map) << map.error().message();
  EXPECT_TRUE(map->direction_at({300.0, 500.0}));
  EXPECT_FALSE(map->direction_at({1900.0, 500.0}));
  EXPECT_TRUE(std::isinf(map->sigma_at({1900.0, 500.0})));
  EXPECT_FALSE(map->direction_at({-1.0, 5.0}));
}

TEST(MeasuredMap, refuses_too_few_and_collinear_points) {
  const auto few = fit_measured_map(1920, 1080, std::vector<MapSample>(3, {{5.0, 5.0}, {0.0, 0.0, -1.0}, 0.1}));
  ASSERT_FALSE(few);
  EXPECT_EQ(few.error().code(), ErrorCode::kInvalidArgument);
  std::vector<MapSample> line;
  for (int x = 0; x < 1920; x += 4) line.push_back({{x + 0.5, 540.0}, bent({x + 0.5, 540.0}), 0.1});
  const auto on_a_line = fit_measured_map(1920, 1080, line);
  ASSERT_FALSE(on_a_line);
  EXPECT_NE(on_a_line.error().message().find("line"), std::string::npos);
}

TEST(MeasuredMap, becomes_a_warp_with_the_same_directions) {
  const auto map = fit_measured_map(1920, 1080, samples_of(0.0, 0.0, 5));
  ASSERT_TRUE(map);
  const Panorama picture{2048, 1024, 2.0, 0.5, -0.5};
  const auto warp = calibration::warp_of(*map, picture);
  ASSERT_TRUE(warp) << warp.error().message();
  ASSERT_EQ(width_px(*warp), 1920);
  for (int y = 4; y < 1080; y += 90) {
    for (int x = 7; x < 1920; x += 90) {
      const auto drawn = direction_at(*warp, x, y);
      ASSERT_TRUE(drawn);
      const Eigen::Vector3d truth = bent({x + 0.5, y + 0.5});
      EXPECT_NEAR(drawn->azimuth_rad, std::atan2(truth.x(), -truth.z()), 4e-5);
      EXPECT_NEAR(drawn->tan_elevation, truth.y() / std::hypot(truth.x(), truth.z()), 4e-5);
    }
  }
}

TEST(SelectedInverse, has_the_diagonal_of_the_dense_inverse) {
  constexpr int kSize = 60;
  std::mt19937 random(6);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Eigen::MatrixXd dense = 8.0 * Eigen::MatrixXd::Identity(kSize, kSize);
  for (int i = 0; i + 1 < kSize; ++i) {
    dense(i, i + 1) = dense(i + 1, i) = unit(random);
    const int far = (i * 17 + 5) % kSize;
    if (far != i) dense(i, far) = dense(far, i) = unit(random);
  }
  const Eigen::SparseMatrix<double> sparse = dense.sparseView();
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(sparse);
  ASSERT_EQ(factor.info(), Eigen::Success);
  const auto diagonal = inverse_diagonal(factor);
  const Eigen::MatrixXd inverse = dense.inverse();
  for (int i = 0; i < kSize; ++i) EXPECT_NEAR(diagonal[static_cast<std::size_t>(i)], inverse(i, i), 1e-12);
}

}  // namespace
}  // namespace cyclorama::solve
