// SPDX-License-Identifier: Apache-2.0
/// Common parts of the commands that replay records: nodes, network, and the summary of a strategy.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "tests/bench/balance/replay.h"

namespace cyclorama {

struct NetworkOptions {
  std::vector<std::size_t> nodes;
  double network_ms = 0.3;      ///< Round trip between coordinator and node.
  double block_ms = 0.05;       ///< SplitRequest::block_overhead_seconds.
  double node_ms = 0.02;        ///< SplitRequest::node_overhead_seconds.
  double bandwidth_mbit = 1e4;  ///< Bandwidth of the coordinator, for all tiles together.
  double speed = 1.0;           ///< Speed of a node; 1 is one core of the recording machine.
  bool unequal = false;
  double timer_noise = 0.0;
};

void add_network_options(CLI::App* command, NetworkOptions* options);

/// Returns the options for a farm of `nodes` nodes.
[[nodiscard]] ReplayOptions replay_options(const NetworkOptions& options, std::size_t nodes);

/// Time from a view's arrival at the coordinator to its last tile.
[[nodiscard]] double frame_seconds(const ReplayedFrame& frame, const NetworkOptions& options);

/// All frames of one record with one strategy.
struct ReplaySummary {
  double mean = 0.0;  ///< Efficiency.
  double p5 = 0.0;
  double min = 0.0;
  double frames_per_second = 0.0;  ///< Without overlapping frames.
  double gain = 0.0;               ///< Gain in frames per second over `equal`: 0.5 is 50 % more.
  std::size_t below_equal = 0;     ///< Frames that took longer than with `equal`.
  double blocks = 0.0;             ///< Mean per frame, like the three below.
  double nodes = 0.0;
  double steals = 0.0;
  double relative_bytes = 0.0;
  double plan_ms = 0.0;  ///< Median thread time of a split.
};

[[nodiscard]] ReplaySummary summary_of(const std::vector<ReplayedFrame>& frames,
                                       const std::vector<ReplayedFrame>& equal, const NetworkOptions& options);

}  // namespace cyclorama
