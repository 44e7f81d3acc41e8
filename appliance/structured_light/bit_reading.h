// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "appliance/structured_light/pattern_set.h"
#include "common/image/image.h"

namespace cyclorama::structured_light {

/// Pattern less inverse, one unit is 1 / kDifferenceScale of full scale: half the memory of float, and finer than any
/// camera.
using Difference = Image<std::int16_t, 1>;
inline constexpr float kDifferenceScale = 32767.0f;

/// One axis of a view: its bits as they were photographed.
struct AxisBits {
  int finest_bit = 0;
  int bits = 0;  ///< Bits finest_bit to bits - 1 were shown.
  int base_bit = -1;
  int extent_px = 0;                    ///< The projector's columns or rows.
  std::vector<Difference> differences;  ///< By bit, from 0; those below finest_bit are empty.
};

/// What was read, for every pixel of the camera.
struct StripeReading {
  Image<std::uint16_t, 1> position;   ///< The stripe read, in projector pixels; its bits below finest_bit are 0.
  Image<std::uint16_t, 1> undecided;  ///< The bits (of the Gray code) that might as well be the other way.
};

/// How large a difference must be to decide a bit: `sigmas` times its own deviation, and `contrast` of the pixel's
/// amplitude.
struct BitThreshold {
  double sigmas = 0.0;
  double contrast = 0.0;
};

/// `amplitude` and `noise` as Decoded's. Precondition: the differences are complete. Reentrant.
[[nodiscard]] StripeReading read_bits(const AxisBits& axis, const Image<float, 1>& amplitude, double noise,
                                      const BitThreshold& threshold);

/// Whether all readings that the undecided bits leave open lie in the same cell of 2^level pixels, or the next. Gray
/// code promises this at the edge of a stripe: there one bit is open, and both its readings are true. Where all finer
/// bits are decided they must agree that there is an edge: the readings lie no further apart than a cell.
[[nodiscard]] inline bool is_settled(std::uint16_t position, std::uint16_t undecided, int level) {
  const auto whole = static_cast<unsigned>(position);
  const int cell = static_cast<int>(whole >> level);
  for (unsigned open = static_cast<unsigned>(undecided) >> level << level; open != 0; open &= open - 1) {
    const unsigned lowest = open & (~open + 1U);
    // Flipping one bit of a Gray code mirrors all that is below.
    const unsigned other = whole ^ (2U * lowest - 1U);
    if (std::abs(static_cast<int>(other >> level) - cell) > 1) return false;
    const bool finer_are_decided = (static_cast<unsigned>(undecided) & (lowest - 1U)) == 0;
    if (finer_are_decided && std::abs(static_cast<int>(other) - static_cast<int>(whole)) > 1 << level) return false;
  }
  return true;
}

}  // namespace cyclorama::structured_light
