// SPDX-License-Identifier: Apache-2.0
/// The selection of lens models, from the least: whoever calibrates climbs it only as far as left-out measurements agree.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "appliance/calibration/brown_model.h"

namespace cyclorama::calibration {

enum class LensModel {
  kPinhole,     ///< One focal length and the centre.
  kRadial1,     ///< and k1
  kRadial2,     ///< and k2
  kDecentred,   ///< and p1, p2
  kFull,        ///< and k3
  kFullOblong,  ///< and a second focal length
};
inline constexpr std::array kLensModels = {LensModel::kPinhole,   LensModel::kRadial1, LensModel::kRadial2,
                                           LensModel::kDecentred, LensModel::kFull,    LensModel::kFullOblong};

/// A richer model must predict left-out views of a board better by this share, or the smaller one stays.
inline constexpr double kMinModelGain = 0.04;

[[nodiscard]] std::string_view name_of(LensModel model);
/// Nothing for any other text.
[[nodiscard]] std::optional<LensModel> lens_model(std::string_view name);
/// How many numbers the model leaves free.
[[nodiscard]] int freedom_of(LensModel model);
/// Whether both focal lengths are one number.
[[nodiscard]] bool has_square_pixels(LensModel model);
/// Which of a block's coefficients the model holds at 0.
[[nodiscard]] std::vector<int> fixed_values(LensModel model);

}  // namespace cyclorama::calibration
