// SPDX-License-Identifier: Apache-2.0
#include "appliance/structured_light/bit_reading.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cyclorama::structured_light {
namespace {

/// Bit b of `lit` is the value that the picture of bit b showed, bit b of `open` whether that value is undecided.
struct Signs {
  unsigned lit = 0;
  unsigned open = 0;
};

Signs signs_at(const AxisBits& axis, std::size_t pixel, float threshold) {
  Signs signs;
  for (int bit = axis.finest_bit; bit < axis.bits; ++bit) {
    const std::int16_t difference = axis.differences[static_cast<std::size_t>(bit)].data()[pixel];
    if (difference > 0) signs.lit |= 1U << bit;
    if (std::abs(static_cast<float>(difference)) < threshold) signs.open |= 1U << bit;
  }
  return signs;
}

}  // namespace

StripeReading read_bits(const AxisBits& axis, const Image<float, 1>& amplitude, double noise,
                        const BitThreshold& threshold) {
  StripeReading reading{Image<std::uint16_t, 1>(amplitude.width(), amplitude.height()),
                        Image<std::uint16_t, 1>(amplitude.width(), amplitude.height())};
  const auto by_noise = static_cast<float>(threshold.sigmas * std::numbers::sqrt2 * noise);
  const auto by_contrast = static_cast<float>(threshold.contrast);
  const unsigned all = ((1U << axis.bits) - 1U) & ~((1U << axis.finest_bit) - 1U);
  for (std::size_t i = 0; i < amplitude.data().size(); ++i) {
    // At least one unit, since a difference of 0 decides nothing.
    const float min = std::max(1.0f, kDifferenceScale * std::max(by_noise, by_contrast * amplitude.data()[i]));
    Signs signs = signs_at(axis, i, min);
    if (axis.base_bit >= 0) {
      const unsigned base = 1U << axis.base_bit;
      const unsigned coarser = all & ~(2U * base - 1U);
      if ((signs.lit & base) != 0) signs.lit ^= coarser;
      if ((signs.open & base) != 0) signs.open |= coarser;
    }
    unsigned position = signs.lit;
    for (unsigned shift = 1; shift < 16; shift *= 2) position ^= position >> shift;
    reading.position.data()[i] = static_cast<std::uint16_t>(position & all);
    reading.undecided.data()[i] = static_cast<std::uint16_t>(signs.open);
  }
  return reading;
}

}  // namespace cyclorama::structured_light
