// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "appliance/photometry/photometry_input.h"
#include "common/base/result.h"

namespace cyclorama::photometry {

/// Standard deviation of a cell's mean code: of a pixel's noise, and of the rounding that noise does not spread.
[[nodiscard]] double code_sigma(const CellCode& code, std::size_t channel, int pixels, double code_step);

/// One reading of one cell by one channel of the camera.
struct RampReading {
  int light = -1;    ///< 0, 1, 2: red, green, blue; 3: white; -1: black.
  int unknown = -1;  ///< Of the response at its level; -1 where that is known: 0 at black, 1 at full.
  double code = 0.0;
  double exposure = 1.0;  ///< In parts of the shortest of all.
  double sigma = 0.0;     ///< Of the code.
};

/// What shares one `rest` and one `share` per light.
struct RampBlock {
  std::size_t projector = 0;
  std::array<bool, 4> has_light{};
  std::vector<RampReading> readings;
};

/// All ramps as a problem to be solved.
struct RampProblem {
  std::vector<RampBlock> blocks;
  /// Levels between black and full, rising, per projector and light; and the first of their unknowns.
  std::vector<std::array<std::vector<double>, 4>> levels;
  std::vector<std::array<int, 4>> first_unknown;
  int unknowns = 0;
};

/// Some cells of each projector, from its darkest to its brightest. Errors as solve_responses(). Reentrant.
Result<RampProblem> ramp_problem(const PhotometryInput& input);

}  // namespace cyclorama::photometry
