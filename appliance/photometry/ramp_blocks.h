// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "appliance/photometry/photometry_input.h"
#include "common/base/result.h"

namespace cyclorama::photometry {

/// Returns the standard deviation of a cell's mean code, due to the pixels' noise and to the part of the rounding error
/// that noise does not average out.
[[nodiscard]] double code_sigma(const CellCode& code, std::size_t channel, int pixels, double code_step);

/// Reading of one cell in one channel of the camera.
struct RampReading {
  int light = -1;  ///< 0, 1, 2 for red, green, blue; 3 for white; -1 for black.
  /// Index of the unknown, which is the response at the reading's level; -1 at black and at full level, where the
  /// response is known to be 0 and 1.
  int unknown = -1;
  double code = 0.0;
  double exposure = 1.0;  ///< Relative to the shortest exposure.
  double sigma = 0.0;     ///< Standard deviation of the code.
};

/// Readings of one cell of one projector. They have a common `rest`, and one `share` per light: see response_solve.h.
struct RampBlock {
  std::size_t projector = 0;
  std::array<bool, 4> has_light{};
  std::vector<RampReading> readings;
};

/// Least-squares problem over all ramps.
struct RampProblem {
  std::vector<RampBlock> blocks;
  /// Intermediate levels (neither black nor full), increasing, per projector and light; `first_unknown` is the index of
  /// the unknown of the first level.
  std::vector<std::array<std::vector<double>, 4>> levels;
  std::vector<std::array<int, 4>> first_unknown;
  int unknowns = 0;
};

/// Builds the problem from some cells of each projector, from its darkest to its brightest. Errors: those of
/// solve_responses(). Reentrant.
Result<RampProblem> ramp_problem(const PhotometryInput& input);

}  // namespace cyclorama::photometry
