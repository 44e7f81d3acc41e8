// SPDX-License-Identifier: Apache-2.0
/// What it costs a display to move a frame's eye.
#pragma once

#include <string>
#include <vector>

#include "common/base/result.h"

namespace cyclorama {

struct WalkCost {
  int mesh_cells = 0;   ///< Cells of 4 pixels between two vertices; 0: the frame as it came, pixel by pixel.
  double cpu_ms = 0.0;  ///< Processor time of the process, all threads; the median of several runs.
  double wall_ms = 0.0;
};
struct WalkCosts {
  std::string renderer;
  std::vector<WalkCost> each;  ///< Each refresh; the first is without a move.
  WalkCost taken;              ///< A new frame: upload and pass 1.
  WalkCost reusing;            ///< A new frame that reuses earlier ones.
};

/// Measures what comes before pass 2 for frames of a room with pillars, in turns, so that other load meets all alike.
/// Errors: GL's.
Result<WalkCosts> walk_costs(int width, int height, int rounds);

}  // namespace cyclorama
