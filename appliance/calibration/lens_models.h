// SPDX-License-Identifier: Apache-2.0
/// The ladder of lens models, from the least: whoever calibrates climbs it only as far as left-out measurements agree.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "appliance/calibration/brown_model.h"

namespace cyclorama {

enum class LensRung {
  kPinhole,     ///< One focal length and the centre.
  kRadial1,     ///< and k1
  kRadial2,     ///< and k2
  kDecentred,   ///< and p1, p2
  kFull,        ///< and k3
  kFullOblong,  ///< and a second focal length
};
inline constexpr std::array kLensRungs = {LensRung::kPinhole,   LensRung::kRadial1, LensRung::kRadial2,
                                          LensRung::kDecentred, LensRung::kFull,    LensRung::kFullOblong};

/// A richer model must predict left-out views of a board better by this share, or the smaller one stays.
inline constexpr double kWorthARung = 0.04;

[[nodiscard]] std::string_view name_of(LensRung rung);
/// Nothing for any other text.
[[nodiscard]] std::optional<LensRung> lens_rung(std::string_view name);
/// How many numbers the rung leaves free.
[[nodiscard]] int freedom_of(LensRung rung);
/// Whether both focal lengths are one number.
[[nodiscard]] bool has_square_pixels(LensRung rung);
/// Which of a block's coefficients the rung holds at 0.
[[nodiscard]] std::vector<int> fixed_values(LensRung rung);

}  // namespace cyclorama
