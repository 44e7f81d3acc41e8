// SPDX-License-Identifier: Apache-2.0
/// From light on a sensor to the numbers that a camera delivers:
///
///   electrons ─ shot noise, read noise ─▶ / full well + pedestal ─ response ─▶ clip, round to 2^bits - 1
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "drivers/simulated/museum/truth.h"

namespace cyclorama::simulated {

/// Reentrant.
class TrueSensor {
 public:
  explicit TrueSensor(const TrueCamera& camera);

  /// One row of one channel: `electrons` to every `stride`th of `codes`. The same `stream` gives the same noise; no two
  /// rows, channels or photographs should share one.
  void read_row(std::span<const float> electrons, std::uint64_t stream, std::uint16_t* codes, std::size_t stride) const;

  /// Without noise, not rounded: in units of code.
  [[nodiscard]] double expected_code(double electrons) const;

 private:
  float full_well_e_;
  float read_variance_;
  bool has_shot_noise_;
  float pedestal_;
  float max_code_;
  TrueResponse response_;
  std::vector<float> codes_;  ///< At even steps of the amplifier's input, up to 1.
};

/// Bits that look random, from any number. Source: Steele, Lea and Flood, "Fast Splittable Pseudorandom Number
/// Generators", OOPSLA 2014 (SplitMix64's finaliser).
[[nodiscard]] std::uint64_t mixed(std::uint64_t number);
/// Normal deviates of mean 0 and variance 1, at the middles of equally probable steps, a power of two of them.
[[nodiscard]] std::span<const float> normal_quantiles();

}  // namespace cyclorama::simulated
