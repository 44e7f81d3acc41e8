// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "tests/bench/selfcal/selfcal_benches.h"

namespace cyclorama {

int extremes(const ShowContent& content, bool is_quick) {
  const int steps = is_quick ? 100000 : 10000000;
  int failures = 0;
  int cases = 0;
  fmt::print("{:>8} {:>12} {:>14} {:>14} {:>8}\n", "R/P", "steps", "least root", "greatest root", "NEES");
  for (const double ratio : {1e-12, 1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9, 1e12}) {
    std::mt19937_64 random(7);
    std::normal_distribution<double> normal;
    const auto draw = [&](double scale) {
      calibration::PoseStep step;
      for (double& v : step) v = scale * normal(random);
      return step;
    };
    const double walk = 1e-5;
    // P is the variance that the walk adds per step; R is `ratio` times that. The filter starts in its steady state.
    const double variance = ratio * walk * walk;
    const double settled = walk * std::sqrt(0.5 * (1.0 + std::sqrt(1.0 + 4.0 * ratio)));
    healing::PoseFilter filter(settled, settled, {walk, walk});
    calibration::PoseStep off = draw(settled);
    double nees = 0.0;
    int counted = 0;
    double min = 1e300;
    double greatest = 0.0;
    bool is_finite = true;
    for (int i = 0; i < steps && is_finite; ++i) {
      filter.predict(1.0);
      off += draw(walk);
      healing::PoseFilter::Measured measured;
      measured.information = calibration::PoseMatrix::Identity() / variance;
      measured.step = off + draw(std::sqrt(variance));
      off -= filter.update(measured);
      if (i % 16 == 0) {
        nees += filter.root().partialPivLu().solve(off).squaredNorm();
        ++counted;
      }
      if (i % 4096 == 0 || i + 1 == steps) {
        const Eigen::SelfAdjointEigenSolver<calibration::PoseMatrix> parts(filter.covariance());
        min = std::min(min, parts.eigenvalues().minCoeff());
        greatest = std::max(greatest, parts.eigenvalues().maxCoeff());
        is_finite = filter.root().allFinite() && off.allFinite();
      }
    }
    ++cases;
    const double mean = nees / counted;
    // Errors are correlated over about sqrt(ratio) steps, so only every such step is independent. Five deviations.
    const double independent = std::max(1.0, steps / std::max(16.0, 2.0 * std::sqrt(ratio)));
    const double band = 5.0 * std::sqrt(12.0 / independent);
    const bool is_good = is_finite && min > 0.0 && std::abs(mean - 6.0) <= std::max(0.1, band);
    failures += is_good ? 0 : 1;
    fmt::print("{:>8.0e} {:>12} {:>14.3e} {:>14.3e} {:>8.3f}{}\n", ratio, steps, std::sqrt(std::max(min, 0.0)),
               std::sqrt(greatest), mean, is_good ? "" : "  FAILED");
    std::fflush(stdout);
  }
  const auto rooms = room_extremes(content);
  if (!rooms) return 1;
  cases += rooms->cases;
  failures += rooms->failures;
  fmt::print("{}\n", nlohmann::json{{"cases", cases}, {"failures", failures}, {"steps", steps}}.dump());
  return failures == 0 ? 0 : 1;
}

}  // namespace cyclorama
