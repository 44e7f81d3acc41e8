// SPDX-License-Identifier: Apache-2.0
/// Lines and short text drawn into a picture for people. What lies outside of the picture is left out. Reentrant.
#pragma once

#include <array>
#include <string_view>

#include "common/image/image.h"

namespace cyclorama {

using Colour = std::array<std::uint8_t, 3>;  ///< sRGB

[[nodiscard]] RgbImage to_rgb(const GreyImage& grey);

/// A straight line between two places in pixels (the first pixel's centre is (0.5, 0.5)), `width_px` wide, 1 to 16.
/// A place that is not finite draws nothing.
void draw_line(RgbImage* picture, const std::array<double, 2>& from, const std::array<double, 2>& to, Colour colour,
               int width_px = 1);

/// One line of text; `left`, `top` is its upper left corner in pixels. A character is 6 x 8 pixels times `scale`
/// (1 to 16). Letters are shown as capitals, what the font lacks as a box.
void draw_text(RgbImage* picture, int left, int top, std::string_view text, Colour colour, int scale = 1);

}  // namespace cyclorama
