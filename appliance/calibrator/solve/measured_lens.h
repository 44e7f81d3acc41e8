// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

namespace cyclorama {

/// A lens as measurements tell it, of a camera or of a projector: pinhole with Brown's distortion, and how sure one is.
///
///     x = X/Z, y = Y/Z, r² = x² + y²,  s = 1 + k1 r² + k2 r⁴ + k3 r⁶
///     u = f (x s + 2 p1 x y + p2 (r² + 2 x²)) + centre_u        v = f (y s + p1 (r² + 2 y²) + 2 p2 x y) + centre_v
///
/// Frames: x right, y down, z forward; the CENTRE of the first pixel is (0.5, 0.5). A value; reentrant.
/// Source: Brown, "Close-Range Camera Calibration", 1971, with OpenCV's order of the tangential terms.
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

  /// Nothing when the point is not in front, or where the distortion has turned back (so no picture has it).
  [[nodiscard]] std::optional<Eigen::Vector2d> pixel_of(const Eigen::Vector3d& point) const;
  /// Not normalised: z is 1. Nothing when no direction before the distortion's turning point leads there.
  [[nodiscard]] std::optional<Eigen::Vector3d> direction_at(const Eigen::Vector2d& pixel) const;
  [[nodiscard]] bool contains(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= 0.0 && pixel.x() <= width_px && pixel.y() >= 0.0 && pixel.y() <= height_px;
  }
};

/// The formula alone, for automatic differentiation too. Precondition: point[2] > 0.
template <typename T>
void project_through_lens(const T* lens, const T* point, T* ret_pixel) {
  const T x = point[0] / point[2];
  const T y = point[1] / point[2];
  const T r2 = x * x + y * y;
  const T scale = 1.0 + r2 * (lens[MeasuredLens::kK1] + r2 * (lens[MeasuredLens::kK2] + r2 * lens[MeasuredLens::kK3]));
  const T& p1 = lens[MeasuredLens::kP1];
  const T& p2 = lens[MeasuredLens::kP2];
  ret_pixel[0] = lens[MeasuredLens::kFocal] * (x * scale + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x)) +
                 lens[MeasuredLens::kCentreU];
  ret_pixel[1] = lens[MeasuredLens::kFocal] * (y * scale + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y) +
                 lens[MeasuredLens::kCentreV];
}

}  // namespace cyclorama
