// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace cyclorama::coordinator {

/// In which order the farm renders frames of several sessions, so that each gets nodes in proportion to its weight while
/// it wants them, and nothing is kept for it while it does not. Start-time fair queueing: Goyal, Vin, Cheng,
/// "Start-time Fair Queuing", 1996. Costs are cpu-seconds, predicted by the session's last frame. Pure; thread-bound.
class FairShare {
 public:
  /// One session's place in the order.
  struct Flow {
    double weight = 1.0;  ///< Above 0.
    double finish = 0.0;  ///< Virtual time at which its last frame is served.
  };
  /// A frame's start in virtual time: the lower, the sooner. `cost` above 0.
  [[nodiscard]] double start(Flow& flow, double cost);
  /// A frame with that start is being served: who comes later does not start before it.
  void served(double start);

  /// What the wire calls rank. Pictures at rest come after all moving ones, fairly among themselves.
  [[nodiscard]] static std::uint64_t rank_of(double start, bool at_rest);

 private:
  double now_ = 0.0;
};

}  // namespace cyclorama::coordinator
