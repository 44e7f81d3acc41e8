// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/estimator/pose_filter.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <random>

namespace cyclorama::healing {
namespace {

calibration::PoseMatrix random_information(std::mt19937* random, double scale) {
  std::normal_distribution<double> normal;
  calibration::PoseMatrix a;
  for (double& v : a.reshaped()) v = normal(*random);
  return scale * (a * a.transpose() + 0.1 * calibration::PoseMatrix::Identity());
}

calibration::PoseStep random_step(std::mt19937* random, double scale) {
  std::normal_distribution<double> normal;
  calibration::PoseStep step;
  for (double& v : step) v = scale * normal(*random);
  return step;
}

TEST(PoseStep, stepping_and_the_step_between_poses_are_inverses) {
  std::mt19937 random(3);
  for (int i = 0; i < 100; ++i) {
    const calibration::PoseStep position = random_step(&random, 1.0);
    const auto from = calibration::stepped(RigidTransform<frame::Room, frame::Projector>(), position);
    const calibration::PoseStep step = random_step(&random, 0.5);
    EXPECT_LT((calibration::step_between(from, calibration::stepped(from, step)) - step).norm(), 1e-12);
  }
}

TEST(PoseStep, half_a_step_and_the_rest_make_the_whole_step) {
  std::mt19937 random(4);
  const auto from = calibration::stepped(RigidTransform<frame::Room, frame::Projector>(), random_step(&random, 1.0));
  calibration::PoseStep turn = random_step(&random, 0.3);
  turn.tail<3>().setZero();
  const auto to = calibration::stepped(from, turn);
  const auto middle = calibration::between(from, to, 0.5);
  EXPECT_LT((calibration::step_between(middle, to) - 0.5 * turn).norm(), 1e-12);
}

/// The textbook's filter, with inverses of whole matrices, for well-conditioned numbers.
TEST(PoseFilter, agrees_with_the_information_filter) {
  std::mt19937 random(5);
  PoseFilter filter(1.0, 1.0, {0.1, 0.2});
  calibration::PoseMatrix covariance = calibration::PoseMatrix::Identity();
  calibration::PoseStep walk;
  walk << Eigen::Vector3d::Constant(0.01), Eigen::Vector3d::Constant(0.04);
  for (int i = 0; i < 50; ++i) {
    filter.predict(2.0);
    covariance += calibration::PoseMatrix((2.0 * walk).asDiagonal());
    const PoseFilter::Measured measured{random_step(&random, 1.0), random_information(&random, 3.0)};
    const calibration::PoseMatrix posterior = (covariance.inverse() + measured.information).inverse();
    const calibration::PoseStep mean = posterior * measured.information * measured.step;
    const double squared = measured.step.dot((covariance + measured.information.inverse()).inverse() * measured.step);
    EXPECT_NEAR(filter.innovation(measured).squared, squared, 1e-9 * squared);
    EXPECT_EQ(filter.innovation(measured).directions, 6);
    EXPECT_LT((filter.update(measured) - mean).norm(), 1e-9);
    covariance = posterior;
    EXPECT_LT((filter.covariance() - covariance).norm(), 1e-9 * covariance.norm());
  }
}

TEST(PoseFilter, does_not_change_directions_that_were_not_measured) {
  PoseFilter filter(1e-3, 1e-2, {});
  PoseFilter::Measured measured;
  measured.step << 5e-4, 7.0, 7.0, 7.0, 7.0, 7.0;
  measured.information(0, 0) = 1e8;
  EXPECT_EQ(filter.innovation(measured).directions, 1);
  const calibration::PoseStep step = filter.update(measured);
  EXPECT_NEAR(step[0], 5e-4, 1e-5);
  EXPECT_LT(step.tail<5>().norm(), 1e-12);
  EXPECT_NEAR(filter.covariance()(1, 1), 1e-6, 1e-15);
}

TEST(PoseFilter, stays_positive_and_consistent_for_very_unequal_noises) {
  for (const double ratio : {1e-12, 1e-6, 1.0, 1e6, 1e12}) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    const double walk = 1e-5;
    PoseFilter filter(walk, walk, {walk, walk});
    calibration::PoseStep truth = random_step(&random, walk);
    calibration::PoseStep believed = calibration::PoseStep::Zero();
    double nees = 0.0;
    constexpr int kSteps = 4000;
    for (int i = 0; i < kSteps; ++i) {
      filter.predict(1.0);
      truth += random_step(&random, walk);
      const double variance = ratio * walk * walk;
      PoseFilter::Measured measured;
      measured.information = calibration::PoseMatrix::Identity() / variance;
      measured.step = truth - believed + random_step(&random, std::sqrt(variance));
      believed += filter.update(measured);
      const calibration::PoseStep whitened = filter.root().fullPivLu().solve(truth - believed);
      nees += whitened.squaredNorm();
    }
    const Eigen::SelfAdjointEigenSolver<calibration::PoseMatrix> parts(filter.covariance());
    EXPECT_GT(parts.eigenvalues().minCoeff(), 0.0) << ratio;
    // With R/P of 1e12 nothing is ever learned, and all errors belong to one long random walk: only its magnitude can
    // be tested.
    const double mean = nees / kSteps;
    if (ratio <= 1e6) {
      EXPECT_GT(mean, 4.0) << ratio;
      EXPECT_LT(mean, 8.0) << ratio;
    }
  }
}

TEST(PoseFilter, removing_the_prior_gives_the_measurement) {
  std::mt19937 random(8);
  const calibration::PoseMatrix information = random_information(&random, 1e6);
  const calibration::PoseMatrix prior = random_information(&random, 1e5);
  const calibration::PoseStep measured = random_step(&random, 1e-3);
  const calibration::PoseStep posterior = (information + prior).inverse() * (information * measured);
  EXPECT_LT((without_prior(posterior, information, prior).step - measured).norm(), 1e-10);
}

TEST(PoseFilter, its_innovation_limit_is_slightly_above_chi_squared) {
  // The lower bounds are the chi-squared quantiles for a tail of 1e-9; the cube root approximates them from above.
  EXPECT_GT(innovation_limit(1), 37.3);
  EXPECT_LT(innovation_limit(1), 50.0);
  EXPECT_GT(innovation_limit(6), 54.4);
  EXPECT_LT(innovation_limit(6), 60.0);
  EXPECT_EQ(innovation_limit(0), 0.0);
}

TEST(InnovationWindow, detects_several_innovations_that_are_each_insignificant) {
  InnovationWindow window;
  const PoseFilter::Innovation each{25.0, 6};
  EXPECT_LT(each.squared, innovation_limit(each.directions));
  for (int i = 0; i < 3; ++i) {
    window.add(each);
    EXPECT_FALSE(window.is_surprising()) << i;
  }
  window.add(each);
  EXPECT_TRUE(window.is_surprising());
  window.forget();
  EXPECT_FALSE(window.is_surprising());
  // A single innovation never counts, however large, since the filter itself handles it.
  window.add({1e6, 6});
  EXPECT_FALSE(window.is_surprising());
  InnovationWindow nothing;
  for (int i = 0; i < 20; ++i) nothing.add({0.0, 0});
  EXPECT_FALSE(nothing.is_surprising());
}

TEST(InnovationWindow, accepts_undisturbed_innovations) {
  std::mt19937_64 random(11);
  std::chi_squared_distribution<double> six(6.0);
  InnovationWindow window;
  for (int i = 0; i < 200000; ++i) {
    window.add({six(random), 6});
    ASSERT_FALSE(window.is_surprising()) << i;
  }
}

TEST(PoseFilter, measures_a_step_in_deviations_of_its_covariance) {
  PoseFilter filter(2e-3, 5e-2, {});
  calibration::PoseStep step = calibration::PoseStep::Zero();
  EXPECT_EQ(filter.squared_deviations(step), 0.0);
  step[1] = 4e-3;
  step[5] = 1.5e-1;
  EXPECT_NEAR(filter.squared_deviations(step), 4.0 + 9.0, 1e-9);
  EXPECT_LT(innovation_limit(6, 4.0), innovation_limit(6));
  // A tail as large as a normal variable's beyond 4 deviations; for one direction it is shared by both signs, so the
  // limit is above 4 squared.
  EXPECT_NEAR(innovation_limit(1, 4.0), 17.3, 2.0);
}

}  // namespace
}  // namespace cyclorama::healing
