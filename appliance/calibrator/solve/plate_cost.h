// SPDX-License-Identifier: Apache-2.0
/// What a turned camera sees of a direction: the residuals of turn_plate.cpp, apart because automatic differentiation
/// is slow to compile.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>

#include "appliance/calibrator/solve/cell_means.h"

namespace ceres {
class CostFunction;
}

namespace cyclorama {

/// How near the wall is in each direction, in 1/m: a sum of the spherical harmonics up to degree two. Exact for a
/// plane; what it lacks of a corner counts, so where a wall was fitted this is what is added to that wall's own.
inline constexpr int kNearnessTerms = 9;
using Nearness = std::array<double, kNearnessTerms>;

template <typename T>
T nearness_at(const T* terms, const T* d) {
  return terms[0] + terms[1] * d[0] + terms[2] * d[1] + terms[3] * d[2] + terms[4] * d[0] * d[1] +
         terms[5] * d[1] * d[2] + terms[6] * d[2] * d[0] + terms[7] * (d[0] * d[0] - d[2] * d[2]) +
         terms[8] * (3.0 * d[1] * d[1] - 1.0);
}

/// From what the eye at the sweet spot sees to what the camera does: turned by the heading, moved off the axis by
/// (right, forward), pitched up and rolled clockwise. `mount` is {pitch, roll}.
template <typename T>
void to_camera(const T* mount, const T* offset, const T& angle, const T* direction, const T& nearness, T* ret_point) {
  using std::cos;
  using std::sin;
  const T ca = cos(angle);
  const T sa = sin(angle);
  const T x = ca * direction[0] + sa * direction[2] - offset[0] * nearness;
  const T z = -sa * direction[0] + ca * direction[2] + offset[1] * nearness;
  const T cp = cos(mount[0]);
  const T sp = sin(mount[0]);
  const T y = cp * direction[1] + sp * z;
  const T forward = sp * direction[1] - cp * z;
  const T cr = cos(mount[1]);
  const T sr = sin(mount[1]);
  ret_point[0] = cr * x - sr * y;
  ret_point[1] = -(sr * x + cr * y);
  ret_point[2] = forward;
}

/// Where a calibration of before has a place of a projector's picture.
struct KnownSight {
  Eigen::Vector3d direction;  ///< A unit vector.
  double sigma_rad = 1e-4;
};

/// Two residuals in sigmas; blocks: lens (8), mount (2), offset (2), angle (1), direction (3, a unit vector), nearness.
/// `wall_nearness` is added to the last.
[[nodiscard]] std::unique_ptr<ceres::CostFunction> make_sight_cost(const CellMean& seen, double wall_nearness = 0.0);

/// Three residuals in sigmas; blocks: direction (3), and the small turn (3) that brings what is known onto it.
[[nodiscard]] std::unique_ptr<ceres::CostFunction> make_known_sight_cost(const KnownSight& known);

}  // namespace cyclorama
