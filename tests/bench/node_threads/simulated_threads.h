// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "tests/bench/node_threads/block_trace.h"

namespace cyclorama {

struct ThreadsUse {
  double utilisation = 0.0;  ///< Share of all threads' time in which they worked.
  double frames_per_second = 0.0;
  double frame_ms_p50 = 0.0;  ///< From a block's order to its last tile.
  double frame_ms_p99 = 0.0;
};

/// Simulates a node of so many threads that are all as fast as the one that recorded the blocks, each on a processor of
/// its own with memory that never waits. BlockLanes, RenderQueue and CellQueue are the node's code; the threads, as in
/// RenderWorker, Crew and TileSender, take only simulated time. `visits` sessions of as many museums each have two
/// frames in flight, as a coordinator orders them, in turn from the recorded blocks.
[[nodiscard]] ThreadsUse simulated_use(const std::vector<BlockTrace>& blocks, int threads, std::size_t lanes,
                                       int visits, double seconds);

}  // namespace cyclorama
