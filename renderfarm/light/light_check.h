// SPDX-License-Identifier: Apache-2.0
/// Errors of stored light, measured in pictures from held-out eyes. The eyes are random in the walkable area and were
/// not used to compute the light. The reference is path traced in two halves, so that its noise cancels in the errors.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace cyclorama::light {

/// Percentiles over the eyes. With fewer than 100 eyes, the 99th percentile is the maximum.
struct Percentiles {
  float p50 = 0.0f;
  float p95 = 0.0f;
  float p99 = 0.0f;
  friend bool operator==(const Percentiles&, const Percentiles&) = default;
};

/// Returns the percentiles of `values` by the nearest-rank method; zeros if there are no values.
[[nodiscard]] Percentiles percentiles_of(std::vector<float> values);

/// The result of a check. All relative errors are relMSE: the mean of (picture - reference)^2 / (reference^2 + 0.01).
struct LightCheck {
  std::uint32_t eyes = 0;  ///< Number of held-out eyes; 0: not checked, and the other fields mean nothing.
  std::uint32_t reference_samples = 0;
  Percentiles relmse;        ///< Errors of pixels.
  Percentiles block_relmse;  ///< Errors of the means of blocks of 8x8 pixels, in which noise cancels.
  Percentiles flip;          ///< FLIP; includes the reference's noise.
  float bias = 0.0f;         ///< Relative error of the pictures' mean.
  /// relMSE of path tracing for as many processor seconds as the pictures with stored light took.
  float relmse_of_paths = 0.0f;
  std::array<float, 3> worst_eye{};  ///< Eye with the largest block_relmse, in the Scene frame.
  float worst_heading_rad = 0.0f;
  float worst_codes = 0.0f;                       ///< Largest error of a block from that eye, in codes of the display.
  std::array<std::uint32_t, 2> worst_block_px{};  ///< Corner of that block.
  std::uint32_t picture_width_px = 0;             ///< Size of the pictures, 150 degrees wide.
  std::uint32_t picture_height_px = 0;

  /// Returns true if path tracing at the same cost has a smaller error, so that the light is not worth using.
  [[nodiscard]] bool loses_to_paths() const { return eyes > 0 && relmse.p50 > relmse_of_paths; }
  friend bool operator==(const LightCheck&, const LightCheck&) = default;
};

}  // namespace cyclorama::light
