// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "common/image/image.h"

namespace cyclorama::simulated {

/// Converts light to grey levels as a machine-vision camera does: linear, with noise, clipped at white. Immutable;
/// reentrant.
class Sensor {
 public:
  /// `noise_grey` is the standard deviation of the noise in grey levels of 255; 0 or more.
  Sensor(double noise_grey, std::uint32_t seed);
  /// Returns the same picture for the same light, gain, seed and number.
  [[nodiscard]] GreyImage expose(const Image<float, 1>& light, double gain, std::uint64_t number) const;

 private:
  std::uint32_t seed_;
  std::vector<float> noise_;  ///< Normal deviates, read from a different offset for every row of every picture.
};

}  // namespace cyclorama::simulated
