// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "appliance/calibration/brown_model.h"
#include "common/base/result.h"

namespace cyclorama::calibration {

/// Reason why a pixel has no direction.
enum class LensRefusal {
  kNone,
  kNotFinite,   ///< The pixel is NaN or infinite.
  kBeyondFold,  ///< The pixel is beyond the image of the fold.
};

struct SlopeAnswer {
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< (x/z, y/z); zero if there is no direction.
  LensRefusal refusal = LensRefusal::kNone;
  explicit operator bool() const { return refusal == LensRefusal::kNone; }
};

/// A camera's or projector's lens with distortion, and its exact inverse.
///
/// A polynomial distortion folds somewhere: beyond the fold two directions meet in one pixel, and the usual inverse
/// with a fixed number of iterations returns an arbitrary value. This inverse is accurate to 1e-9 px, or reports that
/// there is none:
///
///      distance from the axis in the picture
///         │        ╭──╮            the distortion is the gradient of a potential, so where its Jacobian is positive
///         │      ╱ fold ╲          definite in a whole disc, it is one-to-one there, and its inverse is the only
///         │    ╱     ┊    ╲        minimum of a convex function: Newton's method, each step of which decreases it,
///         │  ╱       ┊             converges from anywhere.
///         └──────────┴────────▶ slope
///            trusted   not
///
/// The disc is the largest one about the axis in which no direction's magnification falls below kMinMagnification of
/// the centre's. With decentring (p1, p2), some slopes just outside the disc would also be valid, but are refused.
/// A value; reentrant.
class BrownLens {
 public:
  static constexpr double kMinMagnification = 1e-3;
  static constexpr double kMaxSlope = 57.0;  ///< Slope at 89° from the axis.
  static constexpr double kRoundTripPx = 1e-9;

  /// Makes a lens. Errors: kInvalidArgument for a size or a focal length that is not positive, or a number that is not
  /// finite.
  static Result<BrownLens> from(const BrownParameters& parameters);

  [[nodiscard]] const BrownParameters& parameters() const { return parameters_; }
  /// Returns the slope up to which the lens is trusted, at most kMaxSlope.
  [[nodiscard]] double trusted_slope() const { return trusted_slope_; }

  /// Returns the pixel of a point, which may be outside the picture; empty if the point is behind the lens, beyond the
  /// trusted slope, or not finite.
  [[nodiscard]] std::optional<Eigen::Vector2d> pixel_of(const Eigen::Vector3d& point) const;
  [[nodiscard]] std::optional<Eigen::Vector2d> pixel_of_slope(const Eigen::Vector2d& slope) const;
  /// Inverse of pixel_of_slope(), accurate to kRoundTripPx.
  [[nodiscard]] SlopeAnswer slope_at(const Eigen::Vector2d& pixel) const;
  /// Returns the derivative of the pixel by the slope: d(u, v) / d(x, y).
  [[nodiscard]] Eigen::Matrix2d jacobian(const Eigen::Vector2d& slope) const;

  /// Checks that every position of the picture has a direction. Errors: kInvalidArgument with the first position that
  /// has none, and the slope of the fold.
  [[nodiscard]] Status covers_picture() const;

 private:
  explicit BrownLens(const BrownParameters& parameters);
  [[nodiscard]] Eigen::Vector2d distorted(const Eigen::Vector2d& slope) const;
  [[nodiscard]] Eigen::Matrix2d distortion_jacobian(const Eigen::Vector2d& slope) const;
  [[nodiscard]] double potential(const Eigen::Vector2d& slope) const;

  BrownParameters parameters_;
  double trusted_slope_;
};

}  // namespace cyclorama::calibration
