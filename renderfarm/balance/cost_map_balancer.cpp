// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/balance/cost_map_balancer.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "renderfarm/balance/cut_search.h"
#include "renderfarm/balance/levelling.h"
#include "renderfarm/balance/node_speeds.h"

namespace cyclorama::balance {
namespace {

/// Minimum work of a piece, in multiples of a block's overhead.
constexpr double kMinPieceWork = 4.0;
/// Minimum gain, as a share of the frame's time, before a piece moves to another node.
constexpr double kMinMoveGain = 0.005;
/// Number of smaller sets of nodes that are tried. Cuts are on a grid, so cuts for a smaller set may be better.
constexpr int kMaxTries = 8;

double usable(double seconds) { return std::isfinite(seconds) ? std::max(seconds, 0.0) : 0.0; }

/// Blocks by node, and the predicted time at which the last block is done.
struct Plan {
  std::vector<std::vector<PlannedBlock>> blocks;
  double seconds = 0.0;
};

class CostMapBalancer final : public Balancer {
 public:
  explicit CostMapBalancer(const CostMapBalancerOptions& options) : options_(options), map_(options.map) {}

  std::vector<PlannedBlock> split(const SplitRequest& request) override {
    const WorkSums work(map_.predict(request));
    const double total = work.of(work.whole());
    block_overhead_ = usable(request.block_overhead_seconds);
    stealing_ = options_.stealing && !request.whole_blocks;
    // While costs are unknown, they may be high enough for any number of nodes.
    node_overhead_ = map_.is_known() ? usable(request.node_overhead_seconds) : 0.0;
    const std::vector<double> speeds = usable_speeds(request.speeds);
    const std::vector<std::size_t> fastest = nodes_that_help(speeds, total, work.whole().count(), node_overhead_);
    if (fastest.empty()) return {};
    double speed = 0.0;
    for (const std::size_t node : fastest) speed += speeds[node];
    Plan best = plan_for(fastest, fastest.size(), speeds, work);
    for (std::size_t fewer = fastest.size() - 1, tries = kMaxTries; fewer > 0 && tries > 0; --fewer, --tries) {
      speed -= speeds[fastest[fewer]];
      if (total / speed + block_overhead_ + node_overhead_ >= best.seconds) break;
      Plan plan = plan_for(fastest, fewer, speeds, work);
      if (plan.seconds < best.seconds) best = std::move(plan);
    }
    std::vector<PlannedBlock> blocks;
    for (const auto& plan : best.blocks) blocks.insert(blocks.end(), plan.begin(), plan.end());
    return blocks;
  }

  void learn(const MeasuredFrame& frame) override { map_.learn(frame); }

 private:
  /// Returns the plan for the `count` fastest nodes.
  [[nodiscard]] Plan plan_for(std::span<const std::size_t> fastest, std::size_t count,
                              const std::vector<double>& all_speeds, const WorkSums& work) const {
    std::vector<std::size_t> nodes(fastest.begin(), fastest.begin() + static_cast<std::ptrdiff_t>(count));
    std::ranges::sort(nodes);
    std::vector<double> speeds;
    for (const std::size_t node : nodes) speeds.push_back(all_speeds[node]);
    const std::vector<CellRect> parts = cut_for_nodes(work, speeds);
    Plan plan{std::vector<std::vector<PlannedBlock>>(count)};
    for (std::size_t i = 0; i < count; ++i) {
      if (!parts[i].empty())
        plan.blocks[i] =
            pieces_of(parts[i], nodes[i], work, stealing_ && count > 1 ? options_.shares : std::vector{1.0},
                      kMinPieceWork * block_overhead_ * speeds[i]);
    }
    if (stealing_)
      level_out(&plan, nodes, speeds,
                kMinMoveGain * work.of(work.whole()) / std::accumulate(speeds.begin(), speeds.end(), 0.0));
    double ordered_at = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      if (plan.blocks[i].empty()) continue;
      double seconds = ordered_at += node_overhead_;
      for (const PlannedBlock& block : plan.blocks[i]) seconds += block_overhead_ + block.predicted_seconds / speeds[i];
      plan.seconds = std::max(plan.seconds, seconds);
    }
    return plan;
  }

  /// Cuts a node's part into pieces by `shares`. A piece of less than `min` work is merged into the one before it.
  [[nodiscard]] std::vector<PlannedBlock> pieces_of(const CellRect& part, std::size_t node, const WorkSums& work,
                                                    std::vector<double> shares, double min) const {
    while (shares.size() > 1 && shares.back() * work.of(part) < min) {
      shares[shares.size() - 2] += shares.back();
      shares.pop_back();
    }
    std::vector<PlannedBlock> plan;
    for (const CellRect& piece : cut_by_shares(work, part, shares)) {
      plan.push_back({node, pixels_of(piece, work.size()), !plan.empty(), work.of(piece)});
    }
    return plan;
  }

  /// Moves pieces between nodes (levelling.h). `min_gain` is the minimum saving in seconds for which a piece is moved.
  void level_out(Plan* plan, const std::vector<std::size_t>& nodes, const std::vector<double>& speeds,
                 double min_gain) const {
    std::vector<NodeQueue> queues;
    for (std::size_t i = 0; i < speeds.size(); ++i) {
      queues.push_back({speeds[i], {}, 0.0});
      const double begun_at = static_cast<double>(i + 1) * node_overhead_;
      for (const PlannedBlock& block : plan->blocks[i]) {
        queues[i].blocks.push_back({block.predicted_seconds + block_overhead_ * speeds[i], block.stealable});
      }
      if (!queues[i].blocks.empty()) queues[i].blocks.front().work += begun_at * speeds[i];
    }
    for (const Move& move : level(queues, min_gain)) {
      PlannedBlock& block = plan->blocks[move.from][move.block];
      plan->blocks[move.to].push_back(block);
      plan->blocks[move.to].back().node = nodes[move.to];
      block.rect = {};
    }
    for (auto& blocks : plan->blocks) {
      std::erase_if(blocks, [](const PlannedBlock& block) { return block.rect.empty(); });
      std::ranges::stable_sort(blocks, [](const PlannedBlock& a, const PlannedBlock& b) {
        return a.stealable != b.stealable ? b.stealable : a.stealable && a.predicted_seconds > b.predicted_seconds;
      });
    }
  }

  CostMapBalancerOptions options_;
  CostMap map_;
  bool stealing_ = false;        ///< For the current request.
  double block_overhead_ = 0.0;  ///< For the current request.
  double node_overhead_ = 0.0;
};

}  // namespace

std::unique_ptr<Balancer> make_cost_map_balancer(const CostMapBalancerOptions& options) {
  return std::make_unique<CostMapBalancer>(options);
}

}  // namespace cyclorama::balance
