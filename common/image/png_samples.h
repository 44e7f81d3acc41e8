// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/base/result.h"

namespace cyclorama {

/// A picture with samples of 8 or 16 bits, row by row. Borrows the samples.
struct PngSamples {
  int width_px = 0;
  int height_px = 0;
  int channels = 3;  ///< 1: grey; 3: red, green, blue.
  int bits = 8;      ///< 8 or 16, in this machine's byte order.
  std::span<const std::byte> samples;
};

/// Encodes `picture`. Errors: kInvalidArgument if it is empty or its number of samples does not match. Reentrant.
Result<std::vector<std::byte>> encode_png(const PngSamples& picture);

}  // namespace cyclorama
