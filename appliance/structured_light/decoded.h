// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "common/image/image.h"

namespace cyclorama::structured_light {

/// Result of decoding one camera pixel.
enum class PixelFate : std::uint8_t {
  kDecoded,
  kDark,                   ///< Receives no light of the projector, or only indirect light.
  kSaturated,              ///< Clipped in the white picture.
  kUnstableBit,            ///< Its undecided bits allow positions more than a stripe apart.
  kDisturbed,              ///< Sum of pattern and inverse varies: something moved or flickers.
  kContradictsNeighbours,  ///< Not part of a large patch of consistent pixels.
};
inline constexpr std::size_t kPixelFates = 6;
[[nodiscard]] constexpr std::string_view name_of(PixelFate fate) {
  constexpr std::array<std::string_view, kPixelFates> kNames = {"decoded",      "dark",      "saturated",
                                                                "unstable bit", "disturbed", "contradicts neighbours"};
  return kNames.at(static_cast<std::size_t>(fate));
}

/// Result of decoding one view of a projector's patterns. All images have the camera's size; no value is ever NaN.
struct Decoded {
  Image<float, 2> position_px;  ///< Projector (x, y); the first pixel extends from 0 to 1. 0 if not decoded.
  Image<float, 2> sigma_px;     ///< Standard deviation per axis; 0 if not decoded.
  Image<PixelFate, 1> fate;
  Image<float, 1> amplitude;     ///< White minus black, in units of Photo.
  Image<float, 1> direct_light;  ///< Light that comes straight from the projector, without black, in units of Photo.
  /// Light that comes by way of other surfaces while white is shown, without black, in units of Photo.
  Image<float, 1> global_light;
  /// Standard deviation of one photograph at one pixel, in units of Photo; measured from the photographs.
  double noise = 0.0;
};

}  // namespace cyclorama::structured_light
