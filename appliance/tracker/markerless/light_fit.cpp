// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/markerless/light_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace cyclorama::tracker {
namespace {

constexpr int kIterations = 5;
/// Minimum scale of Cauchy's loss, about the noise of a dim camera: larger differences lose their influence.
constexpr double kMinScale = 0.03;
/// Regularisation that keeps the surface flat where little of the room is visible.
constexpr double kRidge = 2e-3;

double median_of(std::vector<double>* values) {
  const auto middle = values->begin() + static_cast<std::ptrdiff_t>(values->size() / 2);
  std::nth_element(values->begin(), middle, values->end());
  return *middle;
}

}  // namespace

LightGain fitted_light(const std::vector<LogLightSample>& samples) {
  LightGain gain;
  std::vector<double> values;
  for (const LogLightSample& s : samples) {
    if (s.weight > 0.0) values.push_back(s.log_ratio);
  }
  if (values.size() < 20) return gain;
  gain.coefficients[0] = median_of(&values);
  for (int i = 0; i < kIterations; ++i) {
    values.clear();
    for (const LogLightSample& s : samples) {
      if (s.weight > 0.0) values.push_back(std::abs(s.log_ratio - gain.at(s.x, s.y)));
    }
    const double scale = std::max(kMinScale, 1.5 * median_of(&values));
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
    for (const LogLightSample& s : samples) {
      if (s.weight <= 0.0) continue;
      const Eigen::Matrix<double, 6, 1> terms = LightGain::terms(s.x, s.y);
      const double away = (s.log_ratio - gain.coefficients.dot(terms)) / scale;
      const double weight = s.weight / (1.0 + away * away);
      normal.noalias() += weight * terms * terms.transpose();
      right.noalias() += weight * s.log_ratio * terms;
    }
    const double ridge = kRidge * normal(0, 0);
    normal.diagonal().tail<5>().array() += ridge;
    normal(0, 0) += 1e-9;
    gain.coefficients = normal.ldlt().solve(right);
  }
  if (!gain.coefficients.allFinite()) gain.coefficients.setZero();
  return gain;
}

}  // namespace cyclorama::tracker
