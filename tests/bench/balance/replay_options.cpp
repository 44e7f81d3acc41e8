// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/balance/replay_options.h"

#include <algorithm>
#include <array>

#include "common/base/percentiles.h"

namespace cyclorama {
namespace {

/// Measured: 635 kB for 1920x1080 pixels at quality 85.
constexpr double kJpegBytesPerPx = 635e3 / (1920.0 * 1080.0);
/// Relative speeds of machines of different ages.
constexpr std::array kUnequal{1.0, 0.5, 2.0, 0.75, 1.5, 0.25, 1.0, 4.0};

}  // namespace

void add_network_options(CLI::App* command, NetworkOptions* options) {
  command->add_option("--nodes", options->nodes, "Numbers of nodes, separated by commas")
      ->delimiter(',')
      ->check(CLI::Range(1, 65536))
      ->capture_default_str();
  command->add_flag("--unequal", options->unequal, "Nodes of speeds from 0.25 to 4 in turn");
  command->add_option("--speed", options->speed, "Of a node; 1 is a core of the machine that recorded")
      ->check(CLI::Range(1e-3, 1e6))
      ->capture_default_str();
  command->add_option("--network-ms", options->network_ms, "From coordinator to node and back")
      ->check(CLI::Range(0.0, 1e4))
      ->capture_default_str();
  command->add_option("--block-ms", options->block_ms, "What a block costs its node beside its pixels")
      ->check(CLI::Range(0.0, 1e4))
      ->capture_default_str();
  command->add_option("--node-ms", options->node_ms, "What a node costs the coordinator in each frame")
      ->check(CLI::Range(0.0, 1e4))
      ->capture_default_str();
  command->add_option("--bandwidth", options->bandwidth_mbit, "Of the coordinator, in Mbit/s, for all tiles")
      ->check(CLI::Range(0.01, 1e9))
      ->capture_default_str();
  command->add_option("--timer-noise", options->timer_noise, "Standard deviation of what is told of a cell, relative")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
}

ReplayOptions replay_options(const NetworkOptions& options, std::size_t nodes) {
  ReplayOptions replay;
  for (std::size_t i = 0; i < nodes; ++i) {
    replay.farm.speeds.push_back(options.speed * (options.unequal ? kUnequal[i % kUnequal.size()] : 1.0));
  }
  replay.farm.steal_seconds = 1e-3 * options.network_ms;
  replay.farm.block_overhead_seconds = 1e-3 * options.block_ms;
  replay.farm.node_overhead_seconds = 1e-3 * options.node_ms;
  replay.timer_noise = options.timer_noise;
  return replay;
}

double frame_seconds(const ReplayedFrame& frame, const NetworkOptions& options) {
  const double bits = 8.0 * kJpegBytesPerPx * frame.pixels * frame.relative_bytes;
  // Tiles are sent while others are rendered.
  return 1e-3 * options.network_ms + std::max(frame.seconds, bits / (1e6 * options.bandwidth_mbit));
}

ReplaySummary summary_of(const std::vector<ReplayedFrame>& frames, const std::vector<ReplayedFrame>& equal,
                         const NetworkOptions& options) {
  ReplaySummary sum;
  Percentiles efficiency;
  Percentiles plan_ms;
  double seconds = 0.0;
  double equal_seconds = 0.0;
  const auto count = static_cast<double>(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const ReplayedFrame& frame = frames[i];
    efficiency.add(frame.efficiency);
    plan_ms.add(1e3 * frame.plan_seconds);
    seconds += frame_seconds(frame, options);
    equal_seconds += frame_seconds(equal[i], options);
    sum.below_equal += frame.seconds > equal[i].seconds;
    sum.mean += frame.efficiency / count;
    sum.blocks += static_cast<double>(frame.blocks) / count;
    sum.nodes += static_cast<double>(frame.nodes) / count;
    sum.steals += static_cast<double>(frame.steals) / count;
    sum.relative_bytes += frame.relative_bytes / count;
  }
  sum.p5 = efficiency.at(0.05);
  sum.min = efficiency.at(0.0);
  sum.plan_ms = plan_ms.at(0.5);
  sum.frames_per_second = count / seconds;
  sum.gain = equal_seconds / seconds - 1.0;
  return sum;
}

}  // namespace cyclorama
