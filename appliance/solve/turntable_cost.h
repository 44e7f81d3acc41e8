// SPDX-License-Identifier: Apache-2.0
/// The projection of a direction into the turned camera: the residuals of the turntable's bundle adjustment and their
/// derivatives.
#pragma once

#include <Eigen/Core>
#include <array>

#include "appliance/calibration/calibration.h"
#include "appliance/solve/cell_means.h"

namespace cyclorama::solve {

/// Returns the basis functions of InverseDepthTerms at a direction.
[[nodiscard]] Eigen::Matrix<double, calibration::kInverseDepthTerms, 1> inverse_depth_basis(
    const Eigen::Vector3d& direction);
[[nodiscard]] double inverse_depth_at(const calibration::InverseDepthTerms& terms, const Eigen::Vector3d& direction);

/// Transforms a direction from the sweet spot into the camera frame: turned by the heading, translated off the axis by
/// (right, forward), pitched up and rolled clockwise. `mount` is {pitch, roll}.
template <typename T>
void to_camera(const T* mount, const T* offset, const T& angle, const T* direction, const T& inverse_depth,
               T* ret_point) {
  using std::cos;
  using std::sin;
  const T ca = cos(angle);
  const T sa = sin(angle);
  const T x = ca * direction[0] + sa * direction[2] - offset[0] * inverse_depth;
  const T z = -sa * direction[0] + ca * direction[2] + offset[1] * inverse_depth;
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

/// Direction of a projector's pixel according to an earlier calibration.
struct KnownDirection {
  Eigen::Vector3d direction;  ///< A unit vector.
  double sigma_rad = 1e-4;
};

/// One camera pixel at which a direction of the turntable sees a track.
struct TurntableObservation {
  Eigen::Vector2d camera_px;
  Eigen::Matrix2d whitening;  ///< Converts errors in camera pixels to sigmas of the projector's pixel.

  explicit TurntableObservation(const CellMean& cell);
};

/// Indices of an observation's parameters (those shared by all directions, and one angle) in a residual's Jacobian.
enum ObservationParameter : int {
  kLensIndex = 0,
  kMountIndex = 8,
  kOffsetIndex = 10,
  kInverseDepthIndex = 12,
  kAngleIndex = 21
};
inline constexpr int kObservationParameters = 22;

/// The camera at the solver's current parameters, for the residuals of many observations. A point in the camera frame
/// is linear in the direction and in the wall's inverse depth, so sines and cosines are computed once. A value;
/// reentrant.
class SeenFrom {
 public:
  struct Slopes {
    Eigen::Matrix<double, 2, kObservationParameters> by_numbers;
    Eigen::Matrix<double, 2, 3> by_direction;
  };

  SeenFrom(const std::array<double, 2>& mount, const std::array<double, 2>& offset, double angle_rad);
  /// Computes the residuals, in sigmas, of the unit vector `direction` where the wall has the inverse depth
  /// `wall_inverse_depth` plus that of `terms`; `ret_slopes` may be null. Returns false if the point is behind the
  /// camera.
  bool residuals(const TurntableObservation& observation, const double* lens,
                 const calibration::InverseDepthTerms& terms, double wall_inverse_depth,
                 const Eigen::Vector3d& direction, Eigen::Vector2d* ret_residuals, Slopes* ret_slopes) const;

 private:
  /// point = by_direction * direction + by_inverse_depth * inverse_depth
  struct Linear {
    Eigen::Matrix3d by_direction;
    Eigen::Vector3d by_inverse_depth;
  };
  static constexpr int kPoseNumbers = 5;  // Pitch, roll, right, forward, angle.
  Linear seen_;
  std::array<Linear, kPoseNumbers> slopes_;
};

}  // namespace cyclorama::solve
