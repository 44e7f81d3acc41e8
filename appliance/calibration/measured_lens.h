// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "appliance/calibration/brown_lens.h"
#include "appliance/calibration/lens_model.h"

namespace cyclorama::calibration {

/// A lens as measurements tell it, of a camera or of a projector: Brown's with square pixels, and how sure one is. The
/// formula and its inverse are those of brown_model.h; this adds which numbers are free, and their covariance.
///
/// Frames: x right, y down, z forward; the CENTRE of the first pixel is (0.5, 0.5). A value; reentrant.
struct MeasuredLens {
  enum Parameter { kFocal, kCentreU, kCentreV, kK1, kK2, kK3, kP1, kP2 };
  static constexpr int kParameters = 8;
  using Covariance = Eigen::Matrix<double, kParameters, kParameters>;

  int width_px = 0;
  int height_px = 0;
  std::array<double, kParameters> values{};    ///< By Parameter; the first three in pixels.
  Covariance covariance = Covariance::Zero();  ///< A parameter without variance is known.

  /// Without distortion, centred, with the uncertainties of a data sheet: a twentieth of the focal length, a fiftieth
  /// of the picture's width for its centre.
  static MeasuredLens from_focal(int width_px, int height_px, double focal_px);

  /// Without the covariance. Errors as BrownLens::from().
  [[nodiscard]] Result<BrownLens> brown() const;

  /// Nothing when the point is not in front, or where the distortion has turned back (so no picture has it). Finds the
  /// fold anew at each call, as does direction_at(): who asks for many pixels keeps a brown().
  [[nodiscard]] std::optional<Eigen::Vector2d> pixel_of(const Eigen::Vector3d& point) const;
  /// Not normalised: z is 1. Nothing when no direction before the distortion's turning point leads there.
  [[nodiscard]] std::optional<Eigen::Vector3d> direction_at(const Eigen::Vector2d& pixel) const;
  [[nodiscard]] bool contains(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= 0.0 && pixel.x() <= width_px && pixel.y() >= 0.0 && pixel.y() <= height_px;
  }
};

/// Which of MeasuredLens::values a model holds at 0.
[[nodiscard]] std::vector<int> held_parameters(LensModel model);

/// As MeasuredLens::direction_at().
[[nodiscard]] std::optional<Eigen::Vector3d> direction_through(const BrownLens& lens, const Eigen::Vector2d& pixel);

/// The formula alone, for automatic differentiation too. Precondition: point[2] > 0.
template <typename T>
void project_through_lens(const T* lens, const T* point, T* ret_pixel) {
  using L = MeasuredLens;
  const T block[kBrownValues] = {lens[L::kFocal], lens[L::kFocal], lens[L::kCentreU], lens[L::kCentreV], lens[L::kK1],
                                 lens[L::kK2],    lens[L::kP1],    lens[L::kP2],      lens[L::kK3]};
  const T x = point[0] / point[2];
  const T y = point[1] / point[2];
  brown_pixel(block, x, y, &ret_pixel[0], &ret_pixel[1]);
}

/// The same, with what it changes by.
struct LensSlopes {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> by_point;
  Eigen::Matrix<double, 2, MeasuredLens::kParameters> by_lens;
};
[[nodiscard]] LensSlopes slopes_through_lens(const double* lens, const Eigen::Vector3d& point);

}  // namespace cyclorama::calibration
