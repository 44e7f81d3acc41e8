// SPDX-License-Identifier: Apache-2.0
/// Tone mapping: the only conversion from exposed radiance to code values. Reentrant.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "common/image/image.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::render {

/// Converts exposed radiance to display light in [0, 1], monotonically; NaN and negative light give 0.
///   shoulder  identity up to one half, so that measured and painted values are kept, then an exponential with the
///             same slope that ends at 1
///   linear    identity up to 1, then clipped
///   filmic    the S-curve of film, white from 7.25 on: Narkowicz, "ACES Filmic Tone Mapping Curve", 2016, per channel
[[nodiscard]] inline float tone_mapped(float exposed, scene::ToneCurve curve = scene::ToneCurve::kShoulder) {
  constexpr float kKnee = 0.5f;
  constexpr float kFilmicWhite = 7.25f;  // The fit reaches 1 here; far beyond, it would overflow.
  if (!(exposed > 0.0f)) return 0.0f;
  switch (curve) {
    case scene::ToneCurve::kLinear:
      return std::fmin(exposed, 1.0f);
    case scene::ToneCurve::kFilmic:
      if (exposed >= kFilmicWhite) return 1.0f;
      return std::fmin(exposed * (2.51f * exposed + 0.03f) / (exposed * (2.43f * exposed + 0.59f) + 0.14f), 1.0f);
    case scene::ToneCurve::kShoulder:
      break;
  }
  if (exposed <= kKnee) return exposed;
  return kKnee + (1.0f - kKnee) * (1.0f - std::exp((kKnee - exposed) / (1.0f - kKnee)));
}

/// Table with exactly the codes of linear_to_srgb8(tone_mapped()), at many times the speed.
class ToneTable {
 public:
  explicit ToneTable(scene::ToneCurve curve);
  [[nodiscard]] std::uint8_t code(float exposed) const {
    if (!(exposed > 0.0f)) return 0;  // Includes NaN.
    std::uint8_t code = first_[std::bit_cast<std::uint32_t>(exposed) >> kShift];
    while (exposed >= min_[code + std::size_t{1}]) ++code;
    return code;
  }

 private:
  static constexpr int kShift = 16;  // Keeps 7 bits of the mantissa: steps of 1/128, with one or two codes each.
  /// Code of the darkest light for each value of the leading bits.
  std::array<std::uint8_t, std::size_t{1} << (31 - kShift)> first_{};
  std::array<float, 257> min_{};  ///< Darkest light of each code, then NaN.
};

/// Returns the curve's table, which is created once. Thread-safe.
[[nodiscard]] const ToneTable& tone_table(scene::ToneCurve curve);

/// Converts exposed light, such as Film::mean(), to the code values that Renderer::render() gives.
[[nodiscard]] RgbImage developed(const RadianceImage& exposed, scene::ToneCurve curve);

}  // namespace cyclorama::render
