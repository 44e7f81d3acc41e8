// SPDX-License-Identifier: Apache-2.0
/// Divides a picture into blocks for the nodes, such that all finish at the same time.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "common/image/pixel_rect.h"
#include "renderfarm/balance/work_grid.h"

namespace cyclorama::balance {

/// A picture to be divided.
struct SplitRequest {
  PictureSize size;
  /// Speed of each node, above 0: threads times the measured speed of one. The order of nodes should not change from
  /// frame to frame.
  std::span<const double> speeds;
  /// Heading and width of the picture, so that costs can follow a turn. A span of 0 means that a turn does not shift
  /// the picture, because it is no panorama.
  double heading_rad = 0.0;
  double azimuth_span_rad = 1.0;
  /// Cost of each block to its node besides its pixels, at any speed: orders, a partly filled batch, a JPEG header.
  double block_overhead_seconds = 0.0;
  /// Cost of each participating node to the coordinator, which is serial: its orders and answers.
  double node_overhead_seconds = 0.0;
  /// Position of the eye. While it does not move, a turn shifts the whole picture uniformly.
  std::array<double, 3> eye_m{};
  /// Relative cost of a pixel at this picture's quality, as far as known beforehand, in any constant unit, such as
  /// samples.
  double effort = 1.0;
  /// Number of pictures of equal size, one above another (two for stereo). A cell's prediction comes from its own
  /// picture.
  int stacked = 1;
  /// One block per node, none stealable, for blocks that cost more when divided, because the denoiser reads around
  /// them.
  bool whole_blocks = false;
};

/// Part of the picture for one node.
struct PlannedBlock {
  std::size_t node = 0;  ///< Index into SplitRequest::speeds.
  PixelRect rect;
  /// A node that is done before this block is begun may take it (see stealing.h).
  bool stealable = false;
  /// Expected cost: seconds at speed 1. A guess or 0 before anything is measured.
  double predicted_seconds = 0.0;
  friend bool operator==(const PlannedBlock&, const PlannedBlock&) = default;
};

/// Measured cost of a frame, or the known parts of it. Other fields are those of its SplitRequest.
struct MeasuredFrame {
  PictureSize size;
  std::span<const MeasuredBlock> blocks;
  double heading_rad = 0.0;
  std::array<double, 3> eye_m{};
  double effort = 1.0;
  int stacked = 1;
};

/// Strategy of one session. Pure: it uses no clock, node or connection. Thread-bound.
class Balancer {
 public:
  virtual ~Balancer() = default;
  /// Returns blocks in the order of nodes, and for each node in the order in which it renders them, stealable ones
  /// last. No block is empty; together they tile the picture exactly, cut at multiples of kCutPx (tiles.h). Nodes that
  /// would not help get none. Without speeds there are no blocks.
  [[nodiscard]] virtual std::vector<PlannedBlock> split(const SplitRequest& request) = 0;
  /// Learns from a measured frame. May be called late, after other pictures were split.
  virtual void learn(const MeasuredFrame& frame) = 0;

 protected:
  Balancer() = default;
  Balancer(const Balancer&) = default;
  Balancer& operator=(const Balancer&) = default;
};

enum class BalanceStrategy {
  kEqual,            ///< "equal": area in proportion to speed, always.
  kPbt,              ///< "pbt": the prediction binary tree of Cordasco et al., one uniform cost per block.
  kPbtLeaves,        ///< "pbt-leaves": the same with four leaves per node.
  kCostMap,          ///< "cost-map": a cost per cell that turns with the eye; nothing is stealable.
  kCostMapStealing,  ///< "cost-map-stealing": the same; the last of each node's work is stealable.
};
inline constexpr std::array kBalanceStrategies{BalanceStrategy::kEqual, BalanceStrategy::kPbt,
                                               BalanceStrategy::kPbtLeaves, BalanceStrategy::kCostMap,
                                               BalanceStrategy::kCostMapStealing};
[[nodiscard]] std::string_view name_of(BalanceStrategy strategy);
[[nodiscard]] std::optional<BalanceStrategy> balance_strategy_of(std::string_view name);
[[nodiscard]] std::unique_ptr<Balancer> make_balancer(BalanceStrategy strategy);

/// Returns mean load over largest load: 1 is perfect, 1/n means that one node does everything. 1 without any load.
[[nodiscard]] double balance_efficiency(std::span<const double> loads);

}  // namespace cyclorama::balance
