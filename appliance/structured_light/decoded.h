// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "common/image/image.h"

namespace cyclorama::structured_light {

/// What became of a camera's pixel.
enum class PixelFate : std::uint8_t {
  kDecoded,
  kDark,                   ///< The projector gives it no light, or only by way of other walls.
  kSaturated,              ///< The white picture is too bright there.
  kUnstableBit,            ///< Two readings of its bits are more than a stripe apart.
  kDisturbed,              ///< Pattern and inverse do not add up to the same light: something moved, or flickers.
  kContradictsNeighbours,  ///< It belongs to no patch of pixels whose places go together.
};
inline constexpr std::size_t kPixelFates = 6;
[[nodiscard]] constexpr std::string_view name_of(PixelFate fate) {
  constexpr std::array<std::string_view, kPixelFates> kNames = {"decoded",      "dark",      "saturated",
                                                                "unstable bit", "disturbed", "contradicts neighbours"};
  return kNames.at(static_cast<std::size_t>(fate));
}

/// What one view of a projector's patterns tells. All pictures have the camera's size; no value is ever NaN.
struct Decoded {
  Image<float, 2> position_px;  ///< Projector (x, y), the first pixel from 0 to 1; 0 where not decoded.
  Image<float, 2> sigma_px;     ///< Of either; 0 where not decoded.
  Image<PixelFate, 1> fate;
  Image<float, 1> amplitude;     ///< White less black, as Photo.
  Image<float, 1> direct_light;  ///< What comes straight from the projector: as Photo, black taken off.
  Image<float, 1> global_light;  ///< What comes by way of other walls, likewise; at white.
  double noise = 0.0;            ///< Deviation of one photograph at one pixel, as Photo; measured in these very ones.
};

}  // namespace cyclorama::structured_light
