// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "common/image/image.h"

namespace cyclorama::simulated {

/// Light to grey levels, as a camera for machine vision does: proportional, with noise, clipped at white. Immutable;
/// reentrant.
class Sensor {
 public:
  /// `noise_grey`: standard deviation of the noise, in grey levels of 255; 0 or more.
  Sensor(double noise_grey, std::uint32_t seed);
  /// The same for the same light, gain, seed and number.
  [[nodiscard]] GreyImage expose(const Image<float, 1>& light, double gain, std::uint64_t number) const;

 private:
  std::uint32_t seed_;
  std::vector<float> noise_;  ///< Normal deviates, read from another place for every row of every picture.
};

}  // namespace cyclorama::simulated
