// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <random>

#include "appliance/calibration/brown_lens.h"
#include "appliance/calibration/lens_model.h"

namespace cyclorama::calibration {
namespace {

BrownParameters plain_lens() {
  return {.width_px = 1280,
          .height_px = 1024,
          .focal_u_px = 900.0,
          .focal_v_px = 905.0,
          .centre_u_px = 620.0,
          .centre_v_px = 540.0};
}

BrownLens lens_of(const BrownParameters& parameters) {
  auto lens = BrownLens::from(parameters);
  CHECK(lens.has_value());
  return *std::move(lens);
}

/// The usual inverse: a fixed number of iterations without a check of convergence.
Eigen::Vector2d fixed_steps_inverse(const BrownParameters& lens, const Eigen::Vector2d& pixel, int steps) {
  const Eigen::Vector2d wanted((pixel.x() - lens.centre_u_px) / lens.focal_u_px,
                               (pixel.y() - lens.centre_v_px) / lens.focal_v_px);
  Eigen::Vector2d slope = wanted;
  for (int i = 0; i < steps; ++i) {
    const double rr = slope.squaredNorm();
    slope = wanted / (1.0 + rr * (lens.k1 + rr * (lens.k2 + rr * lens.k3)));
  }
  return slope;
}

TEST(BrownLens, without_distortion_it_is_a_pinhole) {
  const BrownLens lens = lens_of(plain_lens());
  EXPECT_EQ(lens.trusted_slope(), BrownLens::kMaxSlope);
  const auto pixel = lens.pixel_of({0.2, -0.1, 2.0});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 620.0 + 90.0, 1e-10);
  EXPECT_NEAR(pixel->y(), 540.0 - 45.25, 1e-10);
  EXPECT_FALSE(lens.pixel_of({0.0, 0.0, -1.0}));
  EXPECT_FALSE(lens.pixel_of({0.0, 0.0, 0.0}));
  EXPECT_TRUE(lens.covers_picture().has_value());
}

TEST(BrownLens, inverts_any_lens_to_a_billionth_of_a_pixel_or_refuses) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int answered = 0;
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    BrownParameters parameters = plain_lens();
    const double wild = std::pow(10.0, 2.0 * unit(random));  // 0.01 to 100
    parameters.k1 = 0.3 * wild * unit(random);
    parameters.k2 = wild * unit(random);
    parameters.k3 = wild * unit(random);
    parameters.p1 = 0.02 * wild * unit(random);
    parameters.p2 = 0.02 * wild * unit(random);
    const BrownLens lens = lens_of(parameters);
    for (int j = 0; j < 20; ++j) {
      const Eigen::Vector2d pixel(640.0 + 900.0 * unit(random), 512.0 + 700.0 * unit(random));
      const SlopeAnswer answer = lens.slope_at(pixel);
      ASSERT_TRUE(answer.slope.allFinite());
      if (!answer) {
        ++refused;
        continue;
      }
      ++answered;
      const auto back = lens.pixel_of_slope(answer.slope);
      ASSERT_TRUE(back);
      EXPECT_LE((*back - pixel).norm(), BrownLens::kRoundTripPx);
    }
  }
  EXPECT_GT(answered, 10000);
  EXPECT_GT(refused, 1000);
}

TEST(BrownLens, finds_every_direction_that_it_images) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 2000; ++i) {
    BrownParameters parameters = plain_lens();
    parameters.k1 = unit(random);
    parameters.k2 = 2.0 * unit(random);
    parameters.k3 = 2.0 * unit(random);
    parameters.p1 = 0.05 * unit(random);
    parameters.p2 = 0.05 * unit(random);
    const BrownLens lens = lens_of(parameters);
    const double reach = std::min(lens.trusted_slope(), 2.0);
    const double angle = 3.14159265 * unit(random);
    const Eigen::Vector2d slope = reach * std::abs(unit(random)) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const auto pixel = lens.pixel_of_slope(slope);
    ASSERT_TRUE(pixel);
    const SlopeAnswer answer = lens.slope_at(*pixel);
    ASSERT_TRUE(answer) << "lens " << i;
    // The inverse of the minimum magnification is the largest amplification of an error.
    EXPECT_LE((answer.slope - slope).norm() * parameters.focal_v_px,
              BrownLens::kRoundTripPx / BrownLens::kMinMagnification);
  }
}

TEST(BrownLens, has_at_least_the_promised_magnification_within_its_trusted_slope) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 300; ++i) {
    BrownParameters parameters = plain_lens();
    parameters.focal_u_px = parameters.focal_v_px = 1.0;
    parameters.k1 = unit(random);
    parameters.k2 = unit(random);
    parameters.k3 = unit(random);
    parameters.p1 = 0.1 * unit(random);
    parameters.p2 = 0.1 * unit(random);
    const BrownLens lens = lens_of(parameters);
    for (int j = 0; j < 50; ++j) {
      const double angle = 3.14159265 * unit(random);
      const Eigen::Vector2d slope =
          lens.trusted_slope() * std::abs(unit(random)) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      const Eigen::Matrix2d jacobian = lens.jacobian(slope);
      EXPECT_GE(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(jacobian).eigenvalues()[0],
                BrownLens::kMinMagnification * (1.0 - 1e-6));
      // Compares with finite differences.
      const double h = 1e-6 * std::max(1.0, slope.norm());
      for (int k = 0; k < 2; ++k) {
        const Eigen::Vector2d step = h * Eigen::Vector2d::Unit(k);
        const auto ahead = lens.pixel_of_slope(slope + step);
        const auto behind = lens.pixel_of_slope(slope - step);
        if (!ahead || !behind) continue;
        const Eigen::Vector2d difference = (*ahead - *behind) / (2.0 * h);
        EXPECT_LE((jacobian.col(k) - difference).norm(), 1e-6 * std::max(1.0, jacobian.norm()));
      }
    }
  }
}

TEST(BrownLens, refuses_pixels_beyond_the_fold_where_fixed_iterations_are_wrong) {
  BrownParameters parameters = plain_lens();
  parameters.k1 = -0.5;  // r (1 - r²/2) has its maximum at r = sqrt(2/3), which is imaged 0.544 from the axis.
  const BrownLens lens = lens_of(parameters);
  EXPECT_NEAR(lens.trusted_slope(), std::sqrt(2.0 / 3.0), 1e-3);
  const Eigen::Vector2d beyond(parameters.centre_u_px + 0.56 * parameters.focal_u_px, parameters.centre_v_px);
  EXPECT_EQ(lens.slope_at(beyond).refusal, LensRefusal::kBeyondFold);
  const Eigen::Vector2d wrong = fixed_steps_inverse(parameters, beyond, 5);
  EXPECT_TRUE(wrong.allFinite());
  const Eigen::Vector2d close(parameters.centre_u_px + 0.544 * parameters.focal_u_px, parameters.centre_v_px);
  const SlopeAnswer answer = lens.slope_at(close);
  ASSERT_TRUE(answer);
  EXPECT_GT((fixed_steps_inverse(parameters, close, 5) - answer.slope).norm() * parameters.focal_u_px, 1.0);
  const Status covers = lens.covers_picture();
  ASSERT_FALSE(covers.has_value());
  EXPECT_EQ(covers.error().code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(covers.error().message(), testing::HasSubstr("folds over"));
}

TEST(BrownLens, refuses_nan) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const BrownLens lens = lens_of(plain_lens());
  EXPECT_EQ(lens.slope_at({nan, 1.0}).refusal, LensRefusal::kNotFinite);
  EXPECT_EQ(lens.slope_at({1.0, -infinity}).refusal, LensRefusal::kNotFinite);
  EXPECT_EQ(lens.slope_at({1e300, 1e308}).refusal, LensRefusal::kBeyondFold);
  EXPECT_FALSE(lens.pixel_of({nan, 0.0, 1.0}));
  EXPECT_FALSE(lens.pixel_of({0.0, 0.0, nan}));
  for (const double bad : {nan, infinity, 1e200}) {
    BrownParameters parameters = plain_lens();
    parameters.k2 = bad;
    EXPECT_FALSE(BrownLens::from(parameters).has_value());
  }
  BrownParameters flat = plain_lens();
  flat.focal_u_px = 0.0;
  EXPECT_FALSE(BrownLens::from(flat).has_value());
}

TEST(BrownLens, converts_to_a_parameter_block_and_back) {
  BrownParameters parameters = plain_lens();
  parameters.k1 = -0.2;
  parameters.p2 = 0.01;
  parameters.k3 = 0.5;
  const BrownParameters back = from_block(to_block(parameters), 1280, 1024);
  EXPECT_EQ(to_block(back), to_block(parameters));
  EXPECT_EQ(back.width_px, 1280);
}

TEST(LensModel, each_has_more_parameters_than_the_one_before) {
  int freedom = 0;
  for (const LensModel model : kLensModels) {
    EXPECT_GT(freedom_of(model), freedom);
    freedom = freedom_of(model);
    EXPECT_FALSE(name_of(model).empty());
  }
  EXPECT_EQ(freedom, kBrownValues);
}

}  // namespace
}  // namespace cyclorama::calibration
