// SPDX-License-Identifier: Apache-2.0
#include "appliance/structured_light/pattern_drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace cyclorama::structured_light {
namespace {

bool bit_at(const PatternSet& set, int bit, int position) {
  const int code = position ^ (position >> 1);
  const bool is_lit = ((code >> bit) & 1) != 0;
  if (set.base_bit < 0 || bit <= set.base_bit) return is_lit;
  return is_lit != (((code >> set.base_bit) & 1) != 0);
}

}  // namespace

double level_at(const PatternSet& set, const PatternPicture& picture, int x, int y) {
  const int position = picture.axis == PatternAxis::kColumns ? x : y;
  switch (picture.kind) {
    case PatternKind::kWhite:
      return 1.0;
    case PatternKind::kBlack:
      return 0.0;
    case PatternKind::kBit:
      return bit_at(set, picture.bit, position) != picture.is_inverse ? 1.0 : 0.0;
    case PatternKind::kPhase: {
      const double turns = (position + 0.5) / set.phase_period_px - static_cast<double>(picture.step) / set.phase_steps;
      return 0.5 + 0.5 * std::cos(2.0 * std::numbers::pi * turns);
    }
    case PatternKind::kLevel:
      return picture.level;
  }
  return 0.0;
}

RgbImage drawn(const PatternSet& set, const PatternPicture& picture) {
  RgbImage image(set.width_px, set.height_px);
  const auto shows = [&picture](PatternLight light) {
    return picture.light == PatternLight::kAll || picture.light == light;
  };
  const std::array<bool, 3> is_shown = {shows(PatternLight::kRed), shows(PatternLight::kGreen),
                                        shows(PatternLight::kBlue)};
  // Pictures of columns repeat one row; pictures of rows have one value per row.
  for (int y = 0; y < set.height_px; ++y) {
    if (y > 0 && picture.axis == PatternAxis::kColumns) {
      std::copy_n(image.at(0, 0), image.row_values(), image.at(0, y));
      continue;
    }
    for (int x = 0; x < set.width_px; ++x) {
      const auto code = static_cast<std::uint8_t>(std::lround(255.0 * level_at(set, picture, x, y)));
      std::uint8_t* const pixel = image.at(x, y);
      for (std::size_t c = 0; c < 3; ++c) pixel[c] = is_shown.at(c) ? code : std::uint8_t{0};
    }
  }
  return image;
}

}  // namespace cyclorama::structured_light
