// SPDX-License-Identifier: Apache-2.0
/// Compensation of one projector's colours: converts the light that the wall should get to the code values that make
/// the projector emit that light. Measured by calibration; without it a head is treated as an sRGB display.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "common/image/image.h"

namespace cyclorama::warp {

using BlackLiftImage = Image<float, 1>;  ///< A factor in [0, 1] on HeadColour::black per projector pixel.

/// The code value in [0, 1] for a channel's light in [0, 1]. Codes are sampled at even steps of the light's square
/// root, from 0 to 1, and interpolated linearly, because the curves of all devices are nearly straight over that root.
struct ResponseCurve {
  std::vector<float> codes;  ///< At least two.

  [[nodiscard]] bool is_valid() const;
  /// Returns the code value for `light`, which is clipped to [0, 1].
  [[nodiscard]] double code_of(double light) const;
  /// Returns the same curve with `steps` values.
  [[nodiscard]] ResponseCurve resampled(std::size_t steps) const;
  static ResponseCurve srgb(std::size_t steps);
  /// Returns the curve of a device whose light is code ^ gamma.
  static ResponseCurve power(double gamma, std::size_t steps);
};

/// Colour pipeline of a head; absent steps cost nothing. It works on linear light to which the blend mask has been
/// applied, in this order: `matrix`; `black`; clipping to [0, 1]; `response`. A value; reentrant.
struct HeadColour {
  std::optional<Eigen::Matrix3d> matrix;  ///< Converts from the wall's primaries to the projector's.
  /// Light added in full where `black_lift` is 1: the black levels of the other projectors.
  Eigen::Vector3d black = Eigen::Vector3d::Zero();
  std::optional<BlackLiftImage> black_lift;              ///< If present, it has the head's size.
  std::optional<std::array<ResponseCurve, 3>> response;  ///< Red, green, blue; absent: sRGB.
};

/// Reference implementation in double precision. shone_light() returns the light that the projector must emit for
/// masked linear light; it may lie outside [0, 1]. codes_of() returns the code values for that light, in [0, 1] and not
/// rounded.
[[nodiscard]] Eigen::Vector3d shone_light(const HeadColour& colour, const Eigen::Vector3d& masked_light,
                                          double black_lift);
[[nodiscard]] Eigen::Vector3d codes_of(const HeadColour& colour, const Eigen::Vector3d& shone_light);

}  // namespace cyclorama::warp
