// SPDX-License-Identifier: Apache-2.0
/// What the camera sees of the projectors that did not move: all of them at once, with a few sines, since it is known
/// to some pixels what each of the camera's pixels sees.
///
///     white, black │ columns: 4 sines, moved by a quarter of a period │ rows likewise     ten photographs
#pragma once

#include <stop_token>
#include <vector>

#include "appliance/scan/view_measuring.h"
#include "appliance/solve/measurements.h"
#include "common/image/image.h"

namespace cyclorama {

/// Of the sines, in projector pixels: what is expected must be right to a quarter of it.
inline constexpr double kWitnessPeriod_px = 64.0;

struct Witness {
  std::size_t projector = 0;  ///< Of the installation.
  int width_px = 0;
  int height_px = 0;
};

/// Which place of which witness each of the camera's pixels should see. Of the camera's size.
struct WitnessExpectation {
  Image<float, 2> place_px;
  Image<std::int16_t, 1> witness;  ///< Counts the witnesses; -1: none, or more than one, or not looked at.
};

struct WitnessView {
  std::vector<Correspondence> places;  ///< Their `projector` counts the witnesses.
  int pictures = 0;
};

/// All projectors must be dark, and are afterwards. `exposure_s` is where the search for the exposure begins.
/// Errors as measure_view(). Blocks.
Result<WitnessView> measure_witnesses(const std::vector<Witness>& witnesses, const WitnessExpectation& expected,
                                      double exposure_s, const ExposureLimits& limits, PatternScreen& screen,
                                      ScanCamera& camera, const PhotographListener& listener, std::stop_token stop);

}  // namespace cyclorama
