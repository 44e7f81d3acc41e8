// SPDX-License-Identifier: Apache-2.0
/// How finely a picture is made: the knobs by which speed is traded for accuracy. Their curves: docs/trade.md.
#pragma once

#include "common/base/result.h"

namespace cyclorama {

inline constexpr int kMostSamples = 1 << 16;
inline constexpr int kMostBounces = 64;
inline constexpr int kMostLightSamples = 16;
inline constexpr double kMostLight = 1e9;  ///< Of a limit or an error.

/// A value. The default is the cheapest picture that shows direct light.
struct RenderQuality {
  int samples = 1;  ///< Per pixel; with adaptive sampling, at most.
  /// The first one's number in the pixel's sequence: pictures of [0, 8) and [8, 16) average to that of [0, 16).
  int first_sample = 0;
  /// How long the pixel's sequence is meant to become; 0 is first_sample + samples. Rounded up to a power of two.
  int sequence = 0;
  int bounces = 0;  ///< Times that light may be scattered between surfaces before the one that the eye sees; 0: direct.
  int light_samples = 1;  ///< Shadow rays at the surface that the eye sees.
  /// A sample of light that arrives indirectly counts for no more than this (exposed luminance); 0 is no limit. What it
  /// took away is reported in RenderCost::removed_light.
  float firefly_limit = 0.0f;
  /// Adaptive sampling stops in a pixel when the standard error of its displayed luminance, and that of its neighbours,
  /// is below this; 0 is off. Never before `adaptive_minimum` samples.
  float adaptive_error = 0.0f;
  int adaptive_minimum = 32;

  friend bool operator==(const RenderQuality&, const RenderQuality&) = default;
};

/// kInvalidArgument, naming the knob and its range.
[[nodiscard]] Status validate(const RenderQuality& quality);
/// The same for one knob; NaN is outside of every range.
[[nodiscard]] Status check_knob(const char* knob, double value, double least, double most);

}  // namespace cyclorama
