// SPDX-License-Identifier: Apache-2.0
/// Who renders what: the picture, cut into one block per node, so that all are done at the same time.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "common/image/pixel_rect.h"
#include "renderfarm/balance/cost_field.h"

namespace cyclorama {

/// One picture to be cut.
struct SplitRequest {
  PictureSize size;
  /// How fast each node is, above 0, in any unit; the order of nodes should stay from frame to frame.
  std::span<const double> speeds;
  /// Where the picture looks and how wide it is, so that a turn can take the costs with it.
  double heading_rad = 0.0;
  double azimuth_span_rad = 1.0;
  /// What each block costs its node beside its pixels, at any speed: orders, a partly filled batch, a JPEG's head.
  double block_overhead_seconds = 0.0;
};

/// Part of the picture for one node.
struct PlannedBlock {
  std::size_t node = 0;  ///< Index into SplitRequest::speeds.
  PixelRect rect;
  /// A node that is done before this block is begun may take it (stealing.h says which and when).
  bool stealable = false;
  /// What it is expected to cost: seconds at speed 1. 0 where nothing is known.
  double predicted_seconds = 0.0;
  friend bool operator==(const PlannedBlock&, const PlannedBlock&) = default;
};

/// What a whole frame cost.
struct MeasuredFrame {
  PictureSize size;
  std::span<const MeasuredBlock> blocks;
  double heading_rad = 0.0;
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

/// "equal": same area for equal speed, always. "pbt": the prediction binary tree on measured costs.
enum class BalanceStrategy { kEqual, kPbt };
[[nodiscard]] std::optional<BalanceStrategy> balance_strategy_of(std::string_view name);
[[nodiscard]] std::unique_ptr<Balancer> make_balancer(BalanceStrategy strategy);

/// Mean load over largest load: 1 is perfect, 1/n is one node doing it all. 1 when there is no load at all.
[[nodiscard]] double balance_efficiency(std::span<const double> loads);

}  // namespace cyclorama
