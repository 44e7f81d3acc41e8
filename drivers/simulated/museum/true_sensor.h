// SPDX-License-Identifier: Apache-2.0
/// Conversion of light on a sensor to the codes that a camera delivers:
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

  /// Reads one row of one channel: `electrons` are written as codes to every `stride`th entry of `codes`. The same
  /// `stream` gives the same noise; each row, channel and photograph needs a different one.
  void read_row(std::span<const float> electrons, std::uint64_t stream, std::uint16_t* codes, std::size_t stride) const;

  /// Returns the code without noise and rounding.
  [[nodiscard]] double expected_code(double electrons) const;

 private:
  float full_well_e_;
  float read_variance_;
  bool has_shot_noise_;
  float pedestal_;
  float max_code_;
  TrueResponse response_;
  std::vector<float> codes_;  ///< Codes at even steps of the amplifier's input, up to 1.
};

/// Maps a number to pseudorandom bits. Source: Steele, Lea and Flood, "Fast Splittable Pseudorandom Number Generators",
/// OOPSLA 2014 (SplitMix64's finaliser).
[[nodiscard]] std::uint64_t mixed(std::uint64_t number);
/// Normal deviates of mean 0 and variance 1, at the midpoints of equally probable steps; their number is a power of
/// two.
[[nodiscard]] std::span<const float> normal_quantiles();

}  // namespace cyclorama::simulated
