// SPDX-License-Identifier: Apache-2.0
#include "appliance/camera_calibration/projector_corners.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "common/base/check.h"

namespace cyclorama::camera_calibration {
namespace {

using Terms = Eigen::Matrix<double, 6, 1>;

struct Sample {
  Terms terms;
  Eigen::Vector2d position;
  Eigen::Vector2d weight;
};

std::vector<Sample> samples_around(const structured_light::Decoded& decoded, const Eigen::Vector2d& centre,
                                   double radius) {
  std::vector<Sample> samples;
  const auto bound = [radius](double at, double sign, int max) {
    return static_cast<int>(std::clamp(std::floor(at + sign * radius), -1.0, static_cast<double>(max)));
  };
  for (int y = std::max(0, bound(centre.y(), -1.0, decoded.fate.height()));
       y <= std::min(decoded.fate.height() - 1, bound(centre.y(), 1.0, decoded.fate.height())); ++y) {
    for (int x = std::max(0, bound(centre.x(), -1.0, decoded.fate.width()));
         x <= std::min(decoded.fate.width() - 1, bound(centre.x(), 1.0, decoded.fate.width())); ++x) {
      const double u = (x + 0.5 - centre.x()) / radius;
      const double v = (y + 0.5 - centre.y()) / radius;
      if (u * u + v * v > 1.0 || *decoded.fate.at(x, y) != structured_light::PixelFate::kDecoded) continue;
      const float* const position = decoded.position_px.at(x, y);
      const float* const sigma = decoded.sigma_px.at(x, y);
      Sample sample;
      sample.terms << 1.0, u, v, u * u, u * v, v * v;
      for (int a = 0; a < 2; ++a) {
        sample.position[a] = static_cast<double>(position[a]);
        sample.weight[a] = 1.0 / std::pow(std::max(1e-3, static_cast<double>(sigma[a])), 2);
      }
      samples.push_back(sample);
    }
  }
  return samples;
}

/// Returns the surface's value at the centre, by least squares with Tukey's weights from the previous round's
/// deviations.
std::optional<double> middle_value(const std::vector<Sample>& samples, int axis) {
  Terms surface = Terms::Zero();
  double spread = 0.0;  // If 0, no sample is an outlier.
  for (int round = 0; round < 6; ++round) {
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Terms right = Terms::Zero();
    double used = 0.0;
    for (const Sample& sample : samples) {
      const double off = spread > 0.0 ? (sample.position[axis] - sample.terms.dot(surface)) / spread : 0.0;
      if (std::abs(off) >= 1.0) continue;
      const double weight = sample.weight[axis] * std::pow(1.0 - off * off, 2);
      normal.noalias() += weight * sample.terms * sample.terms.transpose();
      right += weight * sample.position[axis] * sample.terms;
      used += 1.0;
    }
    if (used < 30.0) return std::nullopt;
    const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> solver(normal);
    if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > 1e-6 * solver.vectorD().maxCoeff())) {
      return std::nullopt;
    }
    surface = solver.solve(right);
    std::vector<double> distances;
    for (const Sample& sample : samples)
      distances.push_back(std::abs(sample.position[axis] - sample.terms.dot(surface)));
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    // 1.48 converts a median to a standard deviation; 4.7 gives 95 % efficiency for normal errors. The lower bound is
    // the noise of stripes' edges.
    spread = 4.7 * std::max(0.02, 1.48 * *middle);
  }
  return surface[0];
}

}  // namespace

std::optional<Eigen::Vector2d> projector_pixel_at(const structured_light::Decoded& decoded,
                                                  const Eigen::Vector2d& camera_px, double radius_px) {
  CHECK(radius_px > 0.0);
  if (!camera_px.allFinite()) return std::nullopt;
  const std::vector<Sample> samples = samples_around(decoded, camera_px, radius_px);
  if (samples.size() < 30) return std::nullopt;
  const auto x = middle_value(samples, 0);
  const auto y = middle_value(samples, 1);
  if (!x || !y || !std::isfinite(*x) || !std::isfinite(*y)) return std::nullopt;
  return Eigen::Vector2d(*x, *y);
}

}  // namespace cyclorama::camera_calibration
