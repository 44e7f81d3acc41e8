// SPDX-License-Identifier: Apache-2.0
/// Divides a picture into blocks for the nodes such that all nodes finish at the same time.
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

/// The input of Balancer::split(): a picture to be divided, and the nodes that will render it.
struct SplitRequest {
  PictureSize size;
  /// Speed of each node, above 0: its threads times the measured speed of one thread. The order of nodes should be the
  /// same in all frames.
  std::span<const double> speeds;
  /// Heading of the picture and the angle that it spans, so that costs can follow a turn. A span of 0 means that a turn
  /// does not shift the picture, because it is not a panorama.
  double heading_rad = 0.0;
  double azimuth_span_rad = 1.0;
  /// Time that each block costs its node in addition to its pixels, whatever the speed: orders, a partly filled batch,
  /// a JPEG header.
  double block_overhead_seconds = 0.0;
  /// Time that each participating node costs the coordinator, which is serial: orders and replies.
  double node_overhead_seconds = 0.0;
  /// Position of the eye, in metres. As long as it is constant, a turn shifts the whole picture uniformly.
  std::array<double, 3> eye_m{};
  /// Expected relative cost of a pixel at this picture's quality, in any constant unit, such as samples.
  double effort = 1.0;
  /// Number of pictures of equal size, one above another (two for stereo). The cost of a cell is predicted from its own
  /// picture only.
  int stacked = 1;
  /// True if each node gets a single block that is not stealable, because dividing it would cost more: the denoiser
  /// reads pixels around each block.
  bool whole_blocks = false;
};

/// Part of the picture for one node.
struct PlannedBlock {
  std::size_t node = 0;  ///< Index into SplitRequest::speeds.
  PixelRect rect;
  /// True if a node that is done before this block is begun may take it (see stealing.h).
  bool stealable = false;
  /// Expected cost in seconds at speed 1; a guess or 0 before anything is measured.
  double predicted_seconds = 0.0;
  friend bool operator==(const PlannedBlock&, const PlannedBlock&) = default;
};

/// Measured costs of a frame or of parts of it. The other fields have the meanings of those in SplitRequest.
struct MeasuredFrame {
  PictureSize size;
  std::span<const MeasuredBlock> blocks;
  double heading_rad = 0.0;
  std::array<double, 3> eye_m{};
  double effort = 1.0;
  int stacked = 1;
};

/// The balancing strategy of one session. Pure: it uses no clock, node or connection. Thread-bound.
class Balancer {
 public:
  virtual ~Balancer() = default;
  /// Divides a picture. Returns blocks in the order of nodes, and for each node in the order in which the node renders
  /// them, stealable blocks last. No block is empty; together they tile the picture exactly, cut at multiples of kCutPx
  /// (tiles.h). Nodes that would not speed up the frame get no block. Without speeds, returns no blocks.
  [[nodiscard]] virtual std::vector<PlannedBlock> split(const SplitRequest& request) = 0;
  /// Learns from a measured frame. May be called late, after other pictures were split.
  virtual void learn(const MeasuredFrame& frame) = 0;

 protected:
  Balancer() = default;
  Balancer(const Balancer&) = default;
  Balancer& operator=(const Balancer&) = default;
};

enum class BalanceStrategy {
  kEqual,            ///< "equal": area always in proportion to speed.
  kPbt,              ///< "pbt": the prediction binary tree of Cordasco et al., with one uniform cost per block.
  kPbtLeaves,        ///< "pbt-leaves": kPbt with four leaves per node.
  kCostMap,          ///< "cost-map": one cost per cell, shifted as the view turns; no block is stealable.
  kCostMapStealing,  ///< "cost-map-stealing": kCostMap, but the last part of each node's work is stealable.
};
inline constexpr std::array kBalanceStrategies{BalanceStrategy::kEqual, BalanceStrategy::kPbt,
                                               BalanceStrategy::kPbtLeaves, BalanceStrategy::kCostMap,
                                               BalanceStrategy::kCostMapStealing};
[[nodiscard]] std::string_view name_of(BalanceStrategy strategy);
[[nodiscard]] std::optional<BalanceStrategy> balance_strategy_of(std::string_view name);
[[nodiscard]] std::unique_ptr<Balancer> make_balancer(BalanceStrategy strategy);

/// Returns mean load over largest load: 1 is perfect, 1/n means that one of n nodes does everything. Returns 1 without
/// load.
[[nodiscard]] double balance_efficiency(std::span<const double> loads);

}  // namespace cyclorama::balance
