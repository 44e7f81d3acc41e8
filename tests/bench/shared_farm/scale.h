// SPDX-License-Identifier: Apache-2.0
/// A large farm over a long time: nodes that leave and come, visits that begin and end, and some greedy museums.
#pragma once

#include <cstddef>

namespace cyclorama {

struct ScaleFigures {
  std::size_t nodes = 0;
  std::size_t nodes_used = 0;
  int museums = 0;
  int frames = 0;
  double utilisation = 0.0;        ///< Worked part of the nodes' time.
  double head_ms_per_frame = 0.0;  ///< Real processor time of the coordinator's state.
  double p99_ms = 0.0;             ///< Time of the honest museums' frames.
  int given_up = 0;                ///< Frames of honest museums.
  int starved = 0;                 ///< Honest museums that got less than 95 % of what they requested.
};

/// Simulates 64 nodes of 4 threads and 50 museums, three of them greedy, for that time.
[[nodiscard]] ScaleFigures measure_scale(double seconds);

}  // namespace cyclorama
