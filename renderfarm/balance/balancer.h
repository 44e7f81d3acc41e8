// SPDX-License-Identifier: Apache-2.0
/// Who renders what: the picture, cut into blocks for the nodes, so that all are done at the same time.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "common/image/pixel_rect.h"
#include "renderfarm/balance/work_grid.h"

namespace cyclorama {

/// One picture to be cut.
struct SplitRequest {
  PictureSize size;
  /// How fast each node is, above 0: threads times the measured speed of one. The order of nodes should stay from frame
  /// to frame.
  std::span<const double> speeds;
  /// Where the picture looks and how wide it is, so that a turn can take the costs with it. A span of 0: no turn shifts
  /// the picture, which is no panorama.
  double heading_rad = 0.0;
  double azimuth_span_rad = 1.0;
  /// What each block costs its node beside its pixels, at any speed: orders, a partly filled batch, a JPEG's head.
  double block_overhead_seconds = 0.0;
  /// What each node that takes part costs the head, one after the other: its orders, its answers.
  double node_overhead_seconds = 0.0;
  /// Where the eye is. Where it has not moved, a turn shifts all of the picture alike.
  std::array<double, 3> eye_m{};
  /// What a pixel of this picture's quality costs, as far as is known beforehand, in any unit that stays: samples, say.
  double effort = 1.0;
  /// Pictures of one size, one above another: two eyes'. What is expected of a cell comes from its own picture.
  int stacked = 1;
  /// One block per node, none stealable: where a block costs more when it is cut, as the denoiser looks around it.
  bool whole_blocks = false;
};

/// Part of the picture for one node.
struct PlannedBlock {
  std::size_t node = 0;  ///< Index into SplitRequest::speeds.
  PixelRect rect;
  /// A node that is done before this block is begun may take it (stealing.h says which and when).
  bool stealable = false;
  /// What it is expected to cost: seconds at speed 1. Before anything is measured a guess, or 0.
  double predicted_seconds = 0.0;
  friend bool operator==(const PlannedBlock&, const PlannedBlock&) = default;
};

/// What a whole frame cost, or the parts of it that are known. The rest as in its SplitRequest.
struct MeasuredFrame {
  PictureSize size;
  std::span<const MeasuredBlock> blocks;
  double heading_rad = 0.0;
  std::array<double, 3> eye_m{};
  double effort = 1.0;
  int stacked = 1;
};

/// Strategy of one session. Thread-bound; pure: it knows no clock, no node and no wire.
class Balancer {
 public:
  virtual ~Balancer() = default;
  /// In the order of nodes, and for each node in the order in which it is to render them, stealable ones last. No block
  /// is empty; together they tile the picture exactly, cut at multiples of kCutPx (tiles.h). Nodes that would not help
  /// get none. No speeds: no blocks.
  [[nodiscard]] virtual std::vector<PlannedBlock> split(const SplitRequest& request) = 0;
  /// May come late: other pictures may have been split meanwhile.
  virtual void learn(const MeasuredFrame& frame) = 0;

 protected:
  Balancer() = default;
  Balancer(const Balancer&) = default;
  Balancer& operator=(const Balancer&) = default;
};

enum class BalanceStrategy {
  kEqual,            ///< "equal": same area for equal speed, always.
  kPbt,              ///< "pbt": the prediction binary tree of Cordasco et al., one cost per block, uniform inside.
  kPbtLeaves,        ///< "pbt-leaves": the same with four leaves per node.
  kCostMap,          ///< "cost-map": ours, a cost per cell that turns with the eye; nothing is stealable.
  kCostMapStealing,  ///< "cost-map-stealing": ours, the last of each node's work in pieces that others may take.
};
inline constexpr std::array kBalanceStrategies{BalanceStrategy::kEqual, BalanceStrategy::kPbt,
                                               BalanceStrategy::kPbtLeaves, BalanceStrategy::kCostMap,
                                               BalanceStrategy::kCostMapStealing};
[[nodiscard]] std::string_view name_of(BalanceStrategy strategy);
[[nodiscard]] std::optional<BalanceStrategy> balance_strategy_of(std::string_view name);
[[nodiscard]] std::unique_ptr<Balancer> make_balancer(BalanceStrategy strategy);

/// Mean load over largest load: 1 is perfect, 1/n is one node doing it all. 1 when there is no load at all.
[[nodiscard]] double balance_efficiency(std::span<const double> loads);

}  // namespace cyclorama
