// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "appliance/calibration/brown_lens.h"
#include "appliance/calibration/lens_model.h"

namespace cyclorama::calibration {

/// A measured lens of a camera or projector: Brown's model with square pixels, and its covariance. The formula and its
/// inverse are those of brown_model.h and brown_lens.h.
///
/// Frames: x right, y down, z forward; the CENTRE of the first pixel is (0.5, 0.5). A value; reentrant.
struct MeasuredLens {
  enum Parameter { kFocal, kCentreU, kCentreV, kK1, kK2, kK3, kP1, kP2 };
  static constexpr int kParameters = 8;
  using Covariance = Eigen::Matrix<double, kParameters, kParameters>;

  int width_px = 0;
  int height_px = 0;
  std::array<double, kParameters> values{};    ///< Indexed by Parameter. The first three are in pixels.
  Covariance covariance = Covariance::Zero();  ///< A parameter with variance 0 is exact.

  /// Returns an undistorted, centred lens with the uncertainties of a data sheet: a twentieth of the focal length, and
  /// a fiftieth of the picture's width for the principal point.
  static MeasuredLens from_focal(int width_px, int height_px, double focal_px);

  /// Returns the lens without its covariance. Errors: those of BrownLens::from().
  [[nodiscard]] Result<BrownLens> brown() const;

  /// Returns the pixel of a point; empty if the point is not in front of the lens or is beyond the fold of the
  /// distortion. Each call of this function or of direction_at() searches for the fold again; for many pixels, keep a
  /// brown().
  [[nodiscard]] std::optional<Eigen::Vector2d> pixel_of(const Eigen::Vector3d& point) const;
  /// Returns a direction with z = 1, not normalised; empty if no direction within the fold of the distortion leads to
  /// `pixel`.
  [[nodiscard]] std::optional<Eigen::Vector3d> direction_at(const Eigen::Vector2d& pixel) const;
  [[nodiscard]] bool contains(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= 0.0 && pixel.x() <= width_px && pixel.y() >= 0.0 && pixel.y() <= height_px;
  }
};

/// Returns the indices of MeasuredLens::values that a model fixes at 0.
[[nodiscard]] std::vector<int> held_parameters(LensModel model);

/// Returns the direction of a pixel. See MeasuredLens::direction_at().
[[nodiscard]] std::optional<Eigen::Vector3d> direction_through(const BrownLens& lens, const Eigen::Vector2d& pixel);

/// Projects a point through a lens, also for automatic differentiation. Precondition: point[2] > 0.
template <typename T>
void project_through_lens(const T* lens, const T* point, T* ret_pixel) {
  using L = MeasuredLens;
  const T block[kBrownValues] = {lens[L::kFocal], lens[L::kFocal], lens[L::kCentreU], lens[L::kCentreV], lens[L::kK1],
                                 lens[L::kK2],    lens[L::kP1],    lens[L::kP2],      lens[L::kK3]};
  const T x = point[0] / point[2];
  const T y = point[1] / point[2];
  brown_pixel(block, x, y, &ret_pixel[0], &ret_pixel[1]);
}

/// The projected pixel with its derivatives.
struct LensSlopes {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> by_point;
  Eigen::Matrix<double, 2, MeasuredLens::kParameters> by_lens;
};
[[nodiscard]] LensSlopes slopes_through_lens(const double* lens, const Eigen::Vector3d& point);

}  // namespace cyclorama::calibration
