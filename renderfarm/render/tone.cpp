// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/tone.h"

#include <algorithm>
#include <limits>

#include "common/image/colour.h"

namespace cyclorama::render {
namespace {

/// Returns the bits of the smallest positive float whose code is at least `code`. The bits of positive floats are
/// ordered like the floats.
std::uint32_t min_bits(scene::ToneCurve curve, int code) {
  std::uint32_t dark = 0;
  std::uint32_t bright = std::bit_cast<std::uint32_t>(std::numeric_limits<float>::infinity());
  while (bright - dark > 1) {
    const std::uint32_t middle = dark + (bright - dark) / 2;
    const bool reached = linear_to_srgb8(tone_mapped(std::bit_cast<float>(middle), curve)) >= code;
    (reached ? bright : dark) = middle;
  }
  return bright;
}

}  // namespace

ToneTable::ToneTable(scene::ToneCurve curve) {
  std::array<std::uint32_t, 256> min{};
  for (int code = 1; code < 256; ++code) {
    min[static_cast<std::size_t>(code)] = min_bits(curve, code);
    min_[static_cast<std::size_t>(code)] = std::bit_cast<float>(min[static_cast<std::size_t>(code)]);
  }
  min_[256] = std::numeric_limits<float>::quiet_NaN();  // No light compares as brighter, so 255 is the last code.
  std::size_t code = 0;
  for (std::size_t i = 0; i < first_.size(); ++i) {
    while (code < 255 && (i << kShift) >= min[code + 1]) ++code;
    first_[i] = static_cast<std::uint8_t>(code);
  }
}

const ToneTable& tone_table(scene::ToneCurve curve) {
  static const ToneTable shoulder(scene::ToneCurve::kShoulder);
  static const ToneTable linear(scene::ToneCurve::kLinear);
  static const ToneTable filmic(scene::ToneCurve::kFilmic);
  return curve == scene::ToneCurve::kLinear ? linear : curve == scene::ToneCurve::kFilmic ? filmic : shoulder;
}

RgbImage developed(const RadianceImage& exposed, scene::ToneCurve curve) {
  const ToneTable& table = tone_table(curve);
  RgbImage codes(exposed.width(), exposed.height());
  std::transform(exposed.data().begin(), exposed.data().end(), codes.data().begin(),
                 [&](float light) { return table.code(light); });
  return codes;
}

}  // namespace cyclorama::render
