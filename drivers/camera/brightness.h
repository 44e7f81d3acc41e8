// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/image/image.h"

namespace cyclorama::camera {

/// The grey level that one pixel in 50 exceeds, from every 7th pixel of every 7th row; 0 of an empty picture. White
/// paper in the visitor's hand covers more of the picture than that, a lamp in the background less.
[[nodiscard]] int bright_level(const GreyImage& picture);

/// A device's gain, in its own units.
struct GainRange {
  long min = 0;
  long max = 0;
  long step = 1;
};

/// With a short, fixed exposure the gain is what is left against the dark. The gain for the pictures to come: higher
/// while the bright level is under 110, lower while it is over 235, by a sixteenth of the range at once; between them
/// it stays, so it cannot swing. Within `range` and on its steps, whatever `gain` is.
[[nodiscard]] long next_gain(long gain, int bright_level, const GainRange& range);

}  // namespace cyclorama::camera
