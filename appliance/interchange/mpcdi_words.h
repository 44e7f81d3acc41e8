// SPDX-License-Identifier: Apache-2.0
/// MPCDI's words for enumerators, shared by reader and writer.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "appliance/interchange/warp_set.h"

namespace cyclorama::interchange::mpcdi {

inline constexpr std::string_view kManifest = "mpcdi.xml";

template <typename T, std::size_t N>
using Words = std::array<std::pair<std::string_view, T>, N>;

inline constexpr Words<WarpProfile, 4> kProfiles{{{"2d", WarpProfile::k2d},
                                                  {"3d", WarpProfile::k3d},
                                                  {"a3", WarpProfile::kAdvanced3d},
                                                  {"sl", WarpProfile::kShaderLamps}}};
/// The reference library misspells "unknown" as "unkown", and so do some files.
inline constexpr Words<LengthUnit, 9> kUnits{{{"unknown", LengthUnit::kUnknown},
                                              {"unkown", LengthUnit::kUnknown},
                                              {"mm", LengthUnit::kMillimetre},
                                              {"cm", LengthUnit::kCentimetre},
                                              {"dm", LengthUnit::kDecimetre},
                                              {"m", LengthUnit::kMetre},
                                              {"in", LengthUnit::kInch},
                                              {"ft", LengthUnit::kFoot},
                                              {"yd", LengthUnit::kYard}}};
inline constexpr Words<DataOrigin, 5> kOrigins{{{"unknown", DataOrigin::kUnknown},
                                                {"unkown", DataOrigin::kUnknown},
                                                {"idealEyePoint", DataOrigin::kIdealEyePoint},
                                                {"floorCenter", DataOrigin::kFloorCentre},
                                                {"centerOfMass", DataOrigin::kCentreOfMass}}};
inline constexpr Words<WarpInterpolation, 5> kInterpolations{{{"unknown", WarpInterpolation::kUnknown},
                                                              {"unkown", WarpInterpolation::kUnknown},
                                                              {"linear", WarpInterpolation::kLinear},
                                                              {"keystone", WarpInterpolation::kKeystone},
                                                              {"smooth", WarpInterpolation::kSmooth}}};

template <typename T, std::size_t N>
[[nodiscard]] std::optional<T> value_of(const Words<T, N>& words, std::string_view word) {
  for (const auto& [candidate, value] : words) {
    if (candidate == word) return value;
  }
  return std::nullopt;
}

template <typename T, std::size_t N>
[[nodiscard]] std::string_view word_of(const Words<T, N>& words, T value) {
  for (const auto& [word, candidate] : words) {
    if (candidate == value) return word;
  }
  return {};
}

}  // namespace cyclorama::interchange::mpcdi
