// SPDX-License-Identifier: Apache-2.0
/// Draws lines and short texts into pictures that people look at. Parts outside the picture are omitted. Reentrant.
#pragma once

#include <array>
#include <string_view>

#include "common/image/image.h"

namespace cyclorama {

using Colour = std::array<std::uint8_t, 3>;  ///< sRGB

[[nodiscard]] RgbImage to_rgb(const GreyImage& grey);

/// Draws a straight line, `width_px` (1 to 16) wide, between two positions in pixels, where the first pixel's centre is
/// (0.5, 0.5). Draws nothing if a position is not finite.
void draw_line(RgbImage* picture, const std::array<double, 2>& from, const std::array<double, 2>& to, Colour colour,
               int width_px = 1);

/// Draws one line of text, with its upper left corner at (`left`, `top`) in pixels. A character is 6 x 8 pixels times
/// `scale` (1 to 16). Letters are drawn as capitals, and characters that the font lacks as a box.
void draw_text(RgbImage* picture, int left, int top, std::string_view text, Colour colour, int scale = 1);

}  // namespace cyclorama
