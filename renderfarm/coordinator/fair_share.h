// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace cyclorama::coordinator {

/// Orders the frames of several sessions, so that each session gets nodes in proportion to its weight while it needs
/// them; capacity is not reserved for idle sessions. Start-time fair queueing: Goyal, Vin, Cheng, "Start-time Fair
/// Queuing", 1996. Costs are cpu-seconds, predicted by the session's last frame. Pure; thread-bound.
class FairShare {
 public:
  /// The state of one session.
  struct Flow {
    double weight = 1.0;  ///< Must be above 0.
    double finish = 0.0;  ///< Virtual time at which its last frame is served.
  };
  /// Returns a frame's start in virtual time; the lowest start is served first. `cost` must be above 0.
  [[nodiscard]] double start(Flow& flow, double cost);
  /// A frame with that start is being served; no later frame gets an earlier start.
  void served(double start);

  /// Returns the `rank` of wire::RenderBlock. Pictures at rest come after all moving ones, with fair shares among
  /// themselves.
  [[nodiscard]] static std::uint64_t rank_of(double start, bool at_rest);

 private:
  double now_ = 0.0;
};

}  // namespace cyclorama::coordinator
