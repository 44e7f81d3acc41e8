// SPDX-License-Identifier: Apache-2.0
/// The candidate lens models, from the smallest; model selection takes a richer one only if left-out measurements
/// justify it.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "appliance/calibration/brown_model.h"

namespace cyclorama::calibration {

enum class LensModel {
  kPinhole,     ///< One focal length and the principal point.
  kRadial1,     ///< Adds k1.
  kRadial2,     ///< Adds k2.
  kDecentred,   ///< Adds p1, p2.
  kFull,        ///< Adds k3.
  kFullOblong,  ///< Adds a second focal length.
};
inline constexpr std::array kLensModels = {LensModel::kPinhole,   LensModel::kRadial1, LensModel::kRadial2,
                                           LensModel::kDecentred, LensModel::kFull,    LensModel::kFullOblong};

/// Minimum relative improvement on left-out views of a board for which a richer model replaces a smaller one.
inline constexpr double kMinModelGain = 0.04;

[[nodiscard]] std::string_view name_of(LensModel model);
/// Returns the model of that name; empty for any other text.
[[nodiscard]] std::optional<LensModel> lens_model(std::string_view name);
/// Returns the number of free parameters.
[[nodiscard]] int freedom_of(LensModel model);
/// True if both focal lengths are one parameter.
[[nodiscard]] bool has_square_pixels(LensModel model);
/// Returns the indices into a BrownBlock of the coefficients that the model fixes at 0.
[[nodiscard]] std::vector<int> fixed_values(LensModel model);

}  // namespace cyclorama::calibration
