// SPDX-License-Identifier: Apache-2.0
/// A record of costs, frame by frame, on simulated nodes.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "renderfarm/balance/cost_record.h"
#include "tests/bench/balance/simulation.h"

namespace cyclorama {

struct ReplayOptions {
  SimulatedFarm farm;
  double timer_noise =
      0.0;  ///< Standard deviation of what the balancer is told of each cell, relative. The truth stays.
  std::uint32_t seed = 1;
  bool oracle = false;  ///< The balancer knows what the frame itself costs, before it is rendered.
};

struct ReplayedFrame {
  double seconds = 0.0;
  double efficiency = 0.0;
  double plan_seconds = 0.0;  ///< Thread time.
  std::size_t blocks = 0;
  std::size_t nodes = 0;  ///< That were given a block.
  std::size_t steals = 0;
  double pixels = 0.0;
  double relative_bytes = 1.0;  ///< Of JPEG, to those of the picture in one piece.
};

/// All frames but the first, of which nobody can know anything beforehand. The balancer sees what a head sees: a view,
/// then what its frame cost. A new balancer from `make` (for the oracle, for every frame). Deterministic but for
/// plan_seconds.
[[nodiscard]] std::vector<ReplayedFrame> replay(std::span<const RecordedFrame> frames, const ReplayOptions& options,
                                                const std::function<std::unique_ptr<Balancer>()>& make);

/// What tiles that small cost more than one large JPEG: measured, 256 px 4 %, 128 px 13 %, 64 px 50 %, 32 px 200 %.
[[nodiscard]] double relative_jpeg_bytes(const PixelRect& tile);

}  // namespace cyclorama
