// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/inter_reflection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

namespace cyclorama::simulated {
namespace {

constexpr double kPi = std::numbers::pi;
const RigidTransform<frame::Room, frame::Room> kStays;

TrueWall wall_of(const Wall& shape) { return *TrueWall::make(shape, kStays, {}); }
TrueWall sphere(double field_rad) { return wall_of(DomeWall{{Eigen::Vector3d::Zero()}, 3.0, field_rad, 0.0}); }
TrueWall cylinder() { return wall_of(CylinderWall{4.3, 2.2, 0.6, 2.6}); }
TrueWall corner() {
  return wall_of(
      PlanesWall{{WallRectangle::above({-3, 0}, {0, -3}, 0, 2), WallRectangle::above({0, -3}, {3, 0}, 0, 2)}});
}

/// Returns the luminous flux in lumens of light per cell.
double flux(const InterReflection& walls, const InterReflection::Light& light, std::size_t colour = 0) {
  double sum = 0.0;
  for (std::size_t i = 0; i < light.size(); ++i) sum += walls.areas_m2()[i] * light[i][colour];
  return sum;
}

// The integrating sphere: light that enters is reflected until it is absorbed, E = E0 rho / (1 - rho), uniformly.
TEST(InterReflection, agrees_with_the_integrating_sphere) {
  const TrueWall wall = sphere(2.0 * kPi);
  const WallCells cells(wall, 300);
  const InterReflection walls(wall, cells, {0.3, 0.6, 0.9});
  InterReflection::Light direct(cells.count());
  const double lit_area = walls.areas_m2()[7];
  direct[7] = {100.0, 100.0, 100.0};
  const auto indirect = walls.indirect(direct);
  const double spread = 100.0 * lit_area / (4.0 * kPi * 9.0);
  const std::array<double, 3> albedo{0.3, 0.6, 0.9};
  for (std::size_t c = 0; c < 3; ++c) {
    const double expected = spread * albedo[c] / (1.0 - albedo[c]);
    for (const auto& lux : indirect) EXPECT_NEAR(lux[c], expected, 1e-3 * expected);
  }
}

// The form factor of a spherical cap to itself is its share of the sphere's area.
TEST(InterReflection, of_a_cap_is_its_share_of_the_sphere) {
  const TrueWall wall = sphere(0.5 * kPi);
  const WallCells cells(wall, 200);
  const InterReflection walls(wall, cells, {0.8, 0.8, 0.8});
  const double part = 0.5 * (1.0 - std::cos(0.25 * kPi));
  const auto indirect = walls.indirect(InterReflection::Light(cells.count(), {1.0, 1.0, 1.0}));
  for (const auto& lux : indirect) EXPECT_NEAR(lux[0], 0.8 * part / (1.0 - 0.8 * part), 2e-3);
}

// Two squares with a common edge at a right angle exchange 0.20004 of their light. Source: Howell, "A Catalog of
// Radiation Heat Transfer Configuration Factors", C-14.
TEST(InterReflection, across_a_corner_has_the_closed_form) {
  const TrueWall wall =
      wall_of(PlanesWall{{WallRectangle::above({-2, 0}, {0, 0}, 0, 2), WallRectangle::above({0, 0}, {0, 2}, 0, 2)}});
  const WallCells cells(wall, 400);
  const InterReflection walls(wall, cells, {0.5, 0.5, 0.5});
  const std::size_t second = cells.grids()[1].first;
  double exchanged = 0.0;
  for (std::size_t i = 0; i < second; ++i) {
    for (std::size_t j = second; j < cells.count(); ++j) exchanged += walls.areas_m2()[i] * walls.form_factor(i, j);
  }
  EXPECT_NEAR(exchanged / 4.0, 0.20004, 0.004);
}

TEST(InterReflection, conserves_energy_on_every_wall) {
  for (const TrueWall& wall : {sphere(1.6), cylinder(), corner(), wall_of(CylinderWall{2.0, 6.2, 0.0, 3.0})}) {
    const WallCells cells(wall, 250);
    const std::array<double, 3> albedo{0.9, 0.5, 0.0};
    const InterReflection walls(wall, cells, albedo);
    for (std::size_t i = 0; i < cells.count(); ++i) {
      double row = 0.0;
      for (std::size_t j = 0; j < cells.count(); ++j) {
        row += walls.form_factor(i, j);
        EXPECT_NEAR(walls.areas_m2()[i] * walls.form_factor(i, j), walls.areas_m2()[j] * walls.form_factor(j, i),
                    1e-12);
      }
      EXPECT_LE(row, 1.0 + 1e-12);
    }
    std::mt19937 random(3);
    InterReflection::Light direct(cells.count());
    for (auto& lux : direct) lux = {1e-3 * static_cast<double>(random() % 1000), 1.0, 1.0};
    const auto indirect = walls.indirect(direct);
    for (std::size_t c = 0; c < 3; ++c) {
      // Light after one bounce is less than the arriving light: the series is at most that of the integrating sphere.
      EXPECT_LE(flux(walls, indirect, c), flux(walls, direct, c) * albedo[c] / (1.0 - albedo[c]) * (1.0 + 1e-6));
      EXPECT_GE(flux(walls, indirect, c), 0.0);
    }
    EXPECT_EQ(flux(walls, indirect, 2), 0.0);
  }
}

TEST(InterReflection, equals_the_sum_over_repeated_bounces) {
  const TrueWall wall = corner();
  const WallCells cells(wall, 120);
  const InterReflection walls(wall, cells, {0.7, 0.7, 0.7});
  InterReflection::Light direct(cells.count(), {0.0, 0.0, 0.0});
  direct[5] = {50.0, 0.0, 0.0};
  std::vector<double> leaving(cells.count(), 0.0);
  std::vector<double> arriving(cells.count(), 0.0);
  leaving[5] = 0.7 * 50.0;
  for (int bounce = 0; bounce < 60; ++bounce) {
    for (std::size_t i = 0; i < cells.count(); ++i) {
      arriving[i] = 0.0;
      for (std::size_t j = 0; j < cells.count(); ++j) arriving[i] += walls.form_factor(i, j) * leaving[j];
    }
    for (std::size_t i = 0; i < cells.count(); ++i) leaving[i] = 0.7 * (direct[i][0] + arriving[i]);
  }
  const auto indirect = walls.indirect(direct);
  for (std::size_t i = 0; i < cells.count(); ++i) EXPECT_NEAR(indirect[i][0], arriving[i], 1e-4);
}

TEST(WallCells, interpolation_weights_sum_to_one_and_reproduce_a_plane) {
  for (const TrueWall& wall : {cylinder(), corner()}) {
    const WallCells cells(wall, 80);
    std::vector<double> values(cells.count());
    for (std::size_t i = 0; i < cells.count(); ++i) values[i] = cells.low(i).across + cells.high(i).across;
    for (double across = 0.2; across < 0.8; across += 0.07) {
      const auto share = cells.share({0, across, 0.4});
      double sum = 0.0;
      double value = 0.0;
      for (std::size_t k = 0; k < 4; ++k) {
        sum += share.weights[k];
        value += share.weights[k] * 0.5 * values[share.cells[k]];
      }
      EXPECT_NEAR(sum, 1.0, 1e-12);
      EXPECT_NEAR(value, across, 1e-12);
    }
  }
}

}  // namespace
}  // namespace cyclorama::simulated
