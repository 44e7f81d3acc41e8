// SPDX-License-Identifier: Apache-2.0
/// Event simulation of one frame on nodes, without clock, threads or wire.
#pragma once

#include <random>
#include <span>
#include <vector>

#include "renderfarm/balance/balancer.h"

namespace cyclorama {

/// Properties of nodes and network. Seconds.
struct SimulatedFarm {
  std::vector<double> speeds;
  /// From a node's last tile to the start of a stolen block: the way to the coordinator and back.
  double steal_seconds = 0.0;
  double block_overhead_seconds = 0.0;  ///< See SplitRequest.
  double node_overhead_seconds = 0.0;   ///< See SplitRequest: the coordinator's orders are sent one after the other.
  bool stealing = false;
};

struct SimulatedFrame {
  double seconds = 0.0;  ///< Time until the last node has finished.
  std::vector<balance::MeasuredBlock> measured;
  std::size_t steals = 0;
  std::size_t late_steals = 0;  ///< Failed steals: the victim had begun the block before the order arrived.

  /// The work divided by the capacity of all nodes, even those without a block, during the frame.
  [[nodiscard]] double efficiency(std::span<const double> speeds) const;
};

/// `work` is the true cost of each cell, in seconds at speed 1. Every node renders its blocks in order; an idle one may
/// take another's by choose_steal(), with the predicted costs of the plan. Deterministic.
[[nodiscard]] SimulatedFrame simulate(const SimulatedFarm& farm, const balance::WorkGrid& work,
                                      std::span<const balance::PlannedBlock> plan);

}  // namespace cyclorama
