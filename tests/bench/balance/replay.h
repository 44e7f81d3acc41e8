// SPDX-License-Identifier: Apache-2.0
/// Replays a record of costs, frame by frame, on simulated nodes.
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
      0.0;  ///< Relative standard deviation of the cell costs reported to the balancer. The true costs are unchanged.
  std::uint32_t seed = 1;
  bool oracle = false;  ///< Gives the balancer the frame's true costs before it is rendered.
};

struct ReplayedFrame {
  double seconds = 0.0;
  double efficiency = 0.0;
  double plan_seconds = 0.0;  ///< Thread time.
  std::size_t blocks = 0;
  std::size_t nodes = 0;  ///< Nodes that were given a block.
  std::size_t steals = 0;
  double pixels = 0.0;
  double relative_bytes = 1.0;  ///< JPEG bytes relative to those of the picture in one piece.
};

/// Replays all frames but the first, whose costs cannot be predicted. The balancer receives the same input as in a
/// coordinator: a view, then the costs of its frame. `make` creates the balancer (for the oracle, one for every frame).
/// Deterministic except for plan_seconds.
[[nodiscard]] std::vector<ReplayedFrame> replay(std::span<const balance::RecordedFrame> frames,
                                                const ReplayOptions& options,
                                                const std::function<std::unique_ptr<balance::Balancer>()>& make);

/// Bytes of tiles of this size relative to one large JPEG: measured, 256 px +4 %, 128 px +13 %, 64 px +50 %, 32 px +200
/// %.
[[nodiscard]] double relative_jpeg_bytes(const PixelRect& tile);

}  // namespace cyclorama
