// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "appliance/structured_light/pattern_set.h"
#include "common/image/image.h"

namespace cyclorama::structured_light {

/// Pattern minus inverse, in units of full scale / kDifferenceScale: takes half the memory of float, and is finer than
/// any camera.
using Difference = Image<std::int16_t, 1>;
inline constexpr float kDifferenceScale = 32767.0f;

/// Photographed bits of one axis of a view.
struct AxisBits {
  int finest_bit = 0;
  int bits = 0;  ///< Bits finest_bit to bits - 1 were shown.
  int base_bit = -1;
  int extent_px = 0;                    ///< Number of the projector's columns or rows.
  std::vector<Difference> differences;  ///< Indexed by bit, from 0; empty for bits below finest_bit.
};

/// Stripe that was read at every camera pixel.
struct StripeReading {
  Image<std::uint16_t, 1> position;   ///< The stripe in projector pixels; its bits below finest_bit are 0.
  Image<std::uint16_t, 1> undecided;  ///< Undecided bits of the Gray code.
};

/// Minimum difference that decides a bit: `sigmas` times its standard deviation, and `contrast` times the pixel's
/// amplitude.
struct BitThreshold {
  double sigmas = 0.0;
  double contrast = 0.0;
};

/// Reads the stripe at every camera pixel. For `amplitude` and `noise` see Decoded. Precondition: the differences are
/// complete. Reentrant.
[[nodiscard]] StripeReading read_bits(const AxisBits& axis, const Image<float, 1>& amplitude, double noise,
                                      const BitThreshold& threshold);

/// Returns true if all positions that the undecided bits allow are in the same cell of 2^level pixels or an adjacent
/// one. Gray code guarantees this at the edge of a stripe, where one bit is undecided and both of its values give a
/// right position. If all bits finer than an undecided bit are decided, the positions that its two values give must
/// also be at most 2^level pixels apart, as they are at an edge.
[[nodiscard]] inline bool is_settled(std::uint16_t position, std::uint16_t undecided, int level) {
  const auto whole = static_cast<unsigned>(position);
  const int cell = static_cast<int>(whole >> level);
  for (unsigned open = static_cast<unsigned>(undecided) >> level << level; open != 0; open &= open - 1) {
    const unsigned lowest = open & (~open + 1U);
    // Flipping one bit of a Gray code mirrors all lower bits.
    const unsigned other = whole ^ (2U * lowest - 1U);
    if (std::abs(static_cast<int>(other >> level) - cell) > 1) return false;
    const bool finer_are_decided = (static_cast<unsigned>(undecided) & (lowest - 1U)) == 0;
    if (finer_are_decided && std::abs(static_cast<int>(other) - static_cast<int>(whole)) > 1 << level) return false;
  }
  return true;
}

}  // namespace cyclorama::structured_light
