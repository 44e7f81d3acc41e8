// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/image/image.h"

namespace cyclorama::camera {

/// Returns the grey level that 2 % of the pixels exceed, from every 7th pixel of every 7th row; 0 for an empty picture.
/// White paper in the visitor's hand covers more than 2 % of the picture and sets the level; a lamp in the background
/// covers less.
[[nodiscard]] int bright_level(const GreyImage& picture);

/// Range and step of a device's gain, in units of the device.
struct GainRange {
  long min = 0;
  long max = 0;
  long step = 1;
};

/// Returns the gain for the next pictures, within `range` and on one of its steps, whatever `gain` is. Since the
/// exposure is short and fixed, only the gain can compensate for darkness. It rises while the bright level is below 110
/// and falls while it is above 235, by a sixteenth of the range at a time. Between these levels it does not change, so
/// that it cannot oscillate.
[[nodiscard]] long next_gain(long gain, int bright_level, const GainRange& range);

}  // namespace cyclorama::camera
