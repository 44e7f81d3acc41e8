// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace cyclorama::display {

/// How pass 1 leaves light for pass 2.
enum class Texels {
  /// Linear light in half floats, 64 bits: a 40th of a code value of 8 bits, whatever the head does with it. The card
  /// filters.
  kHalves,
  /// The light's square root in 11, 11 and 10 bits: an 11th of a code value of 8 bits on an sRGB head, a sixth in blue.
  /// The shader filters, in linear light. Where a processor draws, half the memory is a third less time.
  kPacked,
};

}  // namespace cyclorama::display
