// SPDX-License-Identifier: Apache-2.0
/// The errors of stored light in pictures from held-out eyes. The eyes are random in the walkable area and were not
/// used to compute the light; the reference is path traced in two halves, so that its own noise cancels in the errors.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace cyclorama::light {

/// Percentiles over the eyes; with fewer than 100 of them, the 99th is the worst.
struct Percentiles {
  float p50 = 0.0f;
  float p95 = 0.0f;
  float p99 = 0.0f;
  friend bool operator==(const Percentiles&, const Percentiles&) = default;
};

/// Returns the percentiles of some values by the nearest rank; zeros if there are none.
[[nodiscard]] Percentiles percentiles_of(std::vector<float> values);

/// All relative errors are relMSE: the mean of (picture - reference)^2 / (reference^2 + 0.01).
struct LightCheck {
  std::uint32_t eyes = 0;  ///< 0: it was not checked, and nothing below has a meaning.
  std::uint32_t reference_samples = 0;
  Percentiles relmse;        ///< Errors of pixels.
  Percentiles block_relmse;  ///< Errors of the means of 8x8 pixels, in which noise cancels.
  Percentiles flip;          ///< Includes the reference's noise.
  float bias = 0.0f;         ///< Relative error of the pictures' mean.
  /// relMSE of path tracing for as many processor seconds as the pictures with stored light took.
  float relmse_of_paths = 0.0f;
  std::array<float, 3> worst_eye{};  ///< With the largest error of blocks; Scene frame.
  float worst_heading_rad = 0.0f;
  float worst_codes = 0.0f;                       ///< Largest error of a block, in codes of the display.
  std::array<std::uint32_t, 2> worst_block_px{};  ///< Its corner in that eye's picture.
  std::uint32_t picture_width_px = 0;             ///< Size of the pictures, 150 degrees wide.
  std::uint32_t picture_height_px = 0;

  /// Returns true if paths at the same cost come nearer to the truth, so the light is not worth its use.
  [[nodiscard]] bool loses_to_paths() const { return eyes > 0 && relmse.p50 > relmse_of_paths; }
  friend bool operator==(const LightCheck&, const LightCheck&) = default;
};

}  // namespace cyclorama::light
