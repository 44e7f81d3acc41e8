// SPDX-License-Identifier: Apache-2.0
/// From exposed radiance to what a display shows: the one place where it is done. Reentrant.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "common/image/image.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama {

/// Exposed radiance to display light in [0, 1], monotone; NaN and negative light give 0.
///   shoulder  untouched up to one half, so that what was measured or painted keeps its value, then an exponential that
///             meets it with the same slope and ends at 1
///   linear    untouched up to 1, then clipped
///   filmic    the S of film, white from 7.25 on: Narkowicz, "ACES Filmic Tone Mapping Curve", 2016, of each channel
[[nodiscard]] inline float tone_mapped(float exposed, ToneCurve curve = ToneCurve::kShoulder) {
  constexpr float kKnee = 0.5f;
  constexpr float kFilmicWhite = 7.25f;  // Where the fit crosses 1; far beyond it would overflow.
  if (!(exposed > 0.0f)) return 0.0f;
  switch (curve) {
    case ToneCurve::kLinear:
      return std::fmin(exposed, 1.0f);
    case ToneCurve::kFilmic:
      if (exposed >= kFilmicWhite) return 1.0f;
      return std::fmin(exposed * (2.51f * exposed + 0.03f) / (exposed * (2.43f * exposed + 0.59f) + 0.14f), 1.0f);
    case ToneCurve::kShoulder:
      break;
  }
  if (exposed <= kKnee) return exposed;
  return kKnee + (1.0f - kKnee) * (1.0f - std::exp((kKnee - exposed) / (1.0f - kKnee)));
}

/// linear_to_srgb8(tone_mapped()) by a table, to the same code value, many times quicker.
class ToneTable {
 public:
  explicit ToneTable(ToneCurve curve);
  [[nodiscard]] std::uint8_t code(float exposed) const {
    if (!(exposed > 0.0f)) return 0;  // NaN too.
    std::uint8_t code = first_[std::bit_cast<std::uint32_t>(exposed) >> kShift];
    while (exposed >= least_[code + std::size_t{1}]) ++code;
    return code;
  }

 private:
  static constexpr int kShift = 16;  // Steps of 1/128 of the light: a code or two each.
  /// The code of the darkest light with these leading bits.
  std::array<std::uint8_t, std::size_t{1} << (31 - kShift)> first_{};
  std::array<float, 257> least_{};  ///< The darkest light of each code; then NaN.
};

/// The curve's table, made once. Thread-safe.
[[nodiscard]] const ToneTable& tone_table(ToneCurve curve);

/// Code values of exposed light (a film's means), as Renderer::render() makes them.
[[nodiscard]] RgbImage developed(const RadianceImage& exposed, ToneCurve curve);

}  // namespace cyclorama
