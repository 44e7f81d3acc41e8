// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/registration.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

namespace cyclorama::solve {
namespace {

constexpr std::size_t kAbout = 20000;  // Approximate number of camera pixels that are compared.

/// Returns the derivative of the direction with respect to the projector's pixel; nothing at the map's rim.
std::optional<Eigen::Matrix<double, 3, 2>> slope_at(const calibration::MeasuredMap& map, const Eigen::Vector2d& pixel) {
  Eigen::Matrix<double, 3, 2> slope;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d step = 4.0 * Eigen::Vector2d::Unit(axis);
    const auto a = map.direction_at(pixel - step);
    const auto b = map.direction_at(pixel + step);
    if (!a || !b) return std::nullopt;
    slope.col(axis) = (*b - *a) / 8.0;
  }
  return slope;
}

std::uint64_t key_of(const Correspondence& c) {
  return static_cast<std::uint64_t>(c.camera_v) << 32 | static_cast<std::uint64_t>(c.camera_u);
}

}  // namespace

MeasuredRegistration measured_registration(const Measurements& measurements,
                                           const calibration::Calibration& calibration) {
  std::vector<double> errors;
  for (const TurntableDirection& direction : measurements.directions) {
    std::vector<const Correspondence*> correspondences;
    for (const Correspondence& c : direction.correspondences) correspondences.push_back(&c);
    std::sort(correspondences.begin(), correspondences.end(), [](const Correspondence* a, const Correspondence* b) {
      return key_of(*a) != key_of(*b) ? key_of(*a) < key_of(*b) : a->projector < b->projector;
    });
    std::vector<std::size_t> shared;
    for (std::size_t i = 1; i < correspondences.size(); ++i) {
      if (key_of(*correspondences[i]) == key_of(*correspondences[i - 1])) shared.push_back(i);
    }
    const std::size_t each = kAbout / measurements.directions.size() + 1;
    for (std::size_t k = 0; k < shared.size(); k += shared.size() / each + 1) {
      const Correspondence& a = *correspondences[shared[k] - 1];
      const Correspondence& b = *correspondences[shared[k]];
      const calibration::MeasuredMap& map_a = calibration.projectors[a.projector].map;
      const calibration::MeasuredMap& map_b = calibration.projectors[b.projector].map;
      const Eigen::Vector2d pixel_b(static_cast<double>(b.projector_x), static_cast<double>(b.projector_y));
      const auto seen_a = map_a.direction_at({static_cast<double>(a.projector_x), static_cast<double>(a.projector_y)});
      const auto seen_b = map_b.direction_at(pixel_b);
      const auto slope = slope_at(map_b, pixel_b);
      if (!seen_a || !seen_b || !slope) continue;
      const double error = (slope->transpose() * *slope).ldlt().solve(slope->transpose() * (*seen_a - *seen_b)).norm();
      if (std::isfinite(error)) errors.push_back(error);
    }
  }
  MeasuredRegistration registration;
  registration.correspondences = errors.size();
  if (errors.empty()) return registration;
  std::sort(errors.begin(), errors.end());
  for (const double error : errors) registration.mean_px += error / static_cast<double>(errors.size());
  registration.p95_px =
      errors[std::min(errors.size() - 1, static_cast<std::size_t>(0.95 * static_cast<double>(errors.size())))];
  return registration;
}

}  // namespace cyclorama::solve
