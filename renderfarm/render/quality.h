// SPDX-License-Identifier: Apache-2.0
/// Quality parameters of a picture, which trade speed for accuracy. See docs/trade.md for the measured curves.
#pragma once

#include "common/base/result.h"

namespace cyclorama::render {

inline constexpr int kMaxSamples = 1 << 16;
inline constexpr int kMaxBounces = 64;
inline constexpr int kMaxLightSamples = 16;
inline constexpr double kMaxRadianceLimit = 1e9;  ///< Upper bound of a firefly limit or an adaptive error.

/// Quality of the samples. A value; the default is the cheapest picture with direct light.
struct RenderQuality {
  int samples = 1;  ///< Samples per pixel; with adaptive sampling, the maximum.
  /// Number of the first sample in the pixel's sequence: pictures of samples [0, 8) and [8, 16) average to the picture
  /// of [0, 16).
  int first_sample = 0;
  /// Intended length of the pixel's sequence; 0 means first_sample + samples. Rounded up to a power of two.
  int sequence = 0;
  int bounces = 0;        ///< Scatterings of light before the one at the visible surface; 0 for direct light only.
  int light_samples = 1;  ///< Shadow rays at the surface that the eye sees.
  /// Upper bound of a sample's indirect light, in exposed luminance; 0 disables it. RenderCost::removed_light reports
  /// what it removes.
  float firefly_limit = 0.0f;
  /// Standard error of displayed luminance below which a pixel gets no more samples, if its neighbours are below it
  /// too; 0 disables adaptive sampling. Every pixel gets at least `adaptive_minimum` samples.
  float adaptive_error = 0.0f;
  int adaptive_minimum = 32;
  /// Reads stored light where the scene has it, and traces paths elsewhere. Pixels get one ray through their middle;
  /// pixels that differ from a neighbour get `samples` rays instead. Has no effect in a scene without stored light.
  bool stored_light = false;

  friend bool operator==(const RenderQuality&, const RenderQuality&) = default;
};

/// Checks all parameters. Errors: kInvalidArgument, naming the parameter and its range.
[[nodiscard]] Status validate(const RenderQuality& quality);
/// Checks one parameter; NaN is outside every range. Errors: see validate().
[[nodiscard]] Status check_knob(const char* knob, double value, double min, double max);

}  // namespace cyclorama::render
