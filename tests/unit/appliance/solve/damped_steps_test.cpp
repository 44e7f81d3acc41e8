// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/damped_steps.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <utility>

namespace cyclorama::solve {
namespace {

/// Residuals and their Jacobian; empty where they have no value.
struct Given {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;
};
using Residuals = std::function<std::optional<Given>(const Eigen::VectorXd&)>;

class Problem : public DampedProblem {
 public:
  Problem(Residuals residuals, Eigen::VectorXd at) : residuals_(std::move(residuals)), at_(std::move(at)) {}
  void weigh_by(RobustLoss /*loss*/) override {}
  std::optional<double> linearise() override {
    const auto given = residuals_(at_);
    if (!given) return std::nullopt;
    normal_ = (given->jacobian.transpose() * given->jacobian).triangularView<Eigen::Lower>();
    gradient_ = given->jacobian.transpose() * given->residuals;
    ++linearised;
    return 0.5 * given->residuals.squaredNorm();
  }
  std::optional<Attempt> attempt(double damping) override {
    Eigen::VectorXd step;
    if (!damped_solution(normal_, gradient_, damping, &step)) return std::nullopt;
    next_ = at_ + step;
    const auto given = residuals_(next_);
    if (!given) return std::nullopt;
    const double predicted = -gradient_.dot(step) - 0.5 * step.dot(normal_.selfadjointView<Eigen::Lower>() * step);
    return Attempt{0.5 * given->residuals.squaredNorm(), predicted, step.norm() / (at_.norm() + 1e-8)};
  }
  void accept() override { at_ = next_; }
  [[nodiscard]] const Eigen::VectorXd& at() const { return at_; }
  int linearised = 0;

 private:
  Residuals residuals_;
  Eigen::VectorXd at_;
  Eigen::VectorXd next_;
  Eigen::VectorXd gradient_;
  Eigen::MatrixXd normal_;
};

std::optional<Given> banana(const Eigen::VectorXd& x) {
  Given given;
  given.residuals = Eigen::Vector2d(10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]);
  given.jacobian = (Eigen::Matrix2d() << -20.0 * x[0], 10.0, -1.0, 0.0).finished();
  return given;
}

TEST(DampedSteps, find_the_minimum_of_a_curved_valley) {
  Problem problem(banana, Eigen::Vector2d(-1.2, 1.0));
  const auto cost = minimise(&problem, {200, 1e-16, 1e-14});
  ASSERT_TRUE(cost);
  EXPECT_LE(*cost, 1e-20);
  EXPECT_LE((problem.at() - Eigen::Vector2d(1.0, 1.0)).norm(), 1e-9);
}

TEST(DampedSteps, need_one_step_for_a_linear_problem) {
  const Eigen::MatrixXd slopes = (Eigen::MatrixXd(3, 2) << 1.0, 2.0, 0.0, 1e-6, 3.0, 0.0).finished();
  const Eigen::Vector3d told(1.0, 2.0, 3.0);
  Problem problem(
      [&](const Eigen::VectorXd& x) {
        return Given{slopes * x - told, slopes};
      },
      Eigen::Vector2d(5.0, 7.0));
  ASSERT_TRUE(minimise(&problem, {}));
  const Eigen::Vector2d exact = slopes.colPivHouseholderQr().solve(told);
  EXPECT_LE((problem.at() - exact).norm(), 1e-6 * exact.norm());
  EXPECT_LE(problem.linearised, 4);
}

TEST(DampedSteps, step_back_where_residuals_have_no_value) {
  const Residuals log_of = [](const Eigen::VectorXd& x) -> std::optional<Given> {
    if (!(x[0] > 0.0)) return std::nullopt;
    Given given;
    given.residuals = Eigen::VectorXd::Constant(1, std::log(x[0]) - 1.0);
    given.jacobian = Eigen::MatrixXd::Constant(1, 1, 1.0 / x[0]);
    return given;
  };
  Problem problem(log_of, Eigen::VectorXd::Constant(1, 40.0));  // The first full step leads below 0.
  ASSERT_TRUE(minimise(&problem, {}));
  EXPECT_NEAR(problem.at()[0], std::exp(1.0), 1e-6);
  Problem nowhere(log_of, Eigen::VectorXd::Constant(1, -1.0));
  EXPECT_FALSE(minimise(&nowhere, {}));
}

TEST(DampedSteps, do_not_change_undetermined_parameters) {
  const Residuals first_alone = [](const Eigen::VectorXd& x) {
    return Given{Eigen::VectorXd::Constant(1, x[0] - 2.0), (Eigen::MatrixXd(1, 2) << 1.0, 0.0).finished()};
  };
  Problem problem(first_alone, Eigen::Vector2d(0.0, 5.0));
  ASSERT_TRUE(minimise(&problem, {}));
  EXPECT_NEAR(problem.at()[0], 2.0, 1e-6);
  EXPECT_EQ(problem.at()[1], 5.0);
}

TEST(RobustLoss, has_the_derivative_of_differences_and_is_quadratic_for_small_errors) {
  for (const RobustLoss loss : {RobustLoss::kHuber, RobustLoss::kCauchy}) {
    for (const double square : {1e-6, 0.5, 8.9, 9.1, 100.0, 1e6}) {
      const double step = 1e-5 * square;
      const double slope =
          (weighed(loss, 3.0, square + step).cost - weighed(loss, 3.0, square - step).cost) / (2.0 * step);
      EXPECT_NEAR(weighed(loss, 3.0, square).weight, 2.0 * slope, 1e-5) << square;
    }
    EXPECT_NEAR(weighed(loss, 3.0, 1e-6).cost, 0.5e-6, 1e-12);
    EXPECT_LT(weighed(loss, 3.0, 1e6).cost, 0.01 * 0.5e6);
  }
}

}  // namespace
}  // namespace cyclorama::solve
