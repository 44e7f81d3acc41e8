// SPDX-License-Identifier: Apache-2.0
/// What one projector does to colours, undone: from the light that the wall should get to the code values that make the
/// projector shine it. Found by calibration; without it a head is taken for an sRGB display.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "common/image/image.h"

namespace cyclorama::warp {

using BlackLiftImage = Image<float, 1>;  ///< A factor in [0, 1] on the head's black per projector pixel.

/// The code value in [0, 1] that makes a channel shine a light in [0, 1]. The values stand at even steps of the light's
/// square root, where all devices' curves are nearly straight, from 0 to 1; between two of them it is a straight line.
struct ResponseCurve {
  std::vector<float> codes;  ///< At least two.

  [[nodiscard]] bool is_valid() const;
  /// `light` outside [0, 1] is clipped.
  [[nodiscard]] double code_of(double light) const;
  /// The same curve with `steps` values.
  [[nodiscard]] ResponseCurve resampled(std::size_t steps) const;
  static ResponseCurve srgb(std::size_t steps);
  /// Of a device whose light is code ^ gamma.
  static ResponseCurve power(double gamma, std::size_t steps);
};

/// What is absent costs nothing. In this order, all in linear light: the blend mask has been applied; `matrix`; black;
/// clipped to [0, 1]; `response`. A value; reentrant.
struct HeadColour {
  std::optional<Eigen::Matrix3d> matrix;                 ///< From the wall's primaries to the projector's.
  Eigen::Vector3d black = Eigen::Vector3d::Zero();       ///< Added where `black_lift` is 1: the others' leaking black.
  std::optional<BlackLiftImage> black_lift;              ///< Of the head's size.
  std::optional<std::array<ResponseCurve, 3>> response;  ///< Red, green, blue; absent: sRGB.
};

/// In double, as plainly as can be written down: the light that the projector must shine for masked linear light, not
/// yet clipped, and the code values in [0, 1], not rounded, that make it.
[[nodiscard]] Eigen::Vector3d shone_light(const HeadColour& colour, const Eigen::Vector3d& masked_light,
                                          double black_lift);
[[nodiscard]] Eigen::Vector3d codes_of(const HeadColour& colour, const Eigen::Vector3d& shone_light);

}  // namespace cyclorama::warp
