// SPDX-License-Identifier: Apache-2.0
/// One frame on simulated nodes, by events: no clock, no thread, no wire.
#pragma once

#include <random>
#include <span>
#include <vector>

#include "renderfarm/balance/balancer.h"

namespace cyclorama {

/// What nodes and network are like. Seconds.
struct SimulatedFarm {
  std::vector<double> speeds;
  /// From a node's last tile to the begin of the block that it gets for it: the way to the head and back.
  double steal_seconds = 0.0;
  double block_overhead_seconds = 0.0;  ///< As in SplitRequest.
  double node_overhead_seconds = 0.0;   ///< As in SplitRequest: the head's orders leave one after the other.
  bool stealing = false;
};

struct SimulatedFrame {
  double seconds = 0.0;  ///< Until the last node is done.
  std::vector<MeasuredBlock> measured;
  std::size_t steals = 0;
  std::size_t late_steals = 0;  ///< In vain: the victim had begun before the word reached it.

  /// Of all nodes, those without a block too: the work over what they could have done in the time.
  [[nodiscard]] double efficiency(std::span<const double> speeds) const;
};

/// `work`: what each cell truly costs, in seconds at speed 1. Every node renders its blocks in order; one that is done
/// may take another's by choose_steal(), with the predicted costs of the plan. Deterministic.
[[nodiscard]] SimulatedFrame simulate(const SimulatedFarm& farm, const WorkGrid& work,
                                      std::span<const PlannedBlock> plan);

}  // namespace cyclorama
