// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/balance/tree_balancer.h"

#include "renderfarm/balance/cost_map.h"
#include "renderfarm/balance/node_speeds.h"
#include "renderfarm/balance/split_tree.h"

namespace cyclorama::balance {
namespace {

/// Returns the blocks. Leaf i belongs to node i % nodes.
std::vector<PlannedBlock> planned(const std::vector<CellRect>& leaves, std::size_t nodes, const WorkSums& work,
                                  bool work_is_known) {
  std::vector<PlannedBlock> blocks;
  for (std::size_t node = 0; node < nodes; ++node) {
    for (std::size_t leaf = node; leaf < leaves.size(); leaf += nodes) {
      if (leaves[leaf].empty()) continue;
      const double seconds = work_is_known ? work.of(leaves[leaf]) : 0.0;
      blocks.push_back({node, pixels_of(leaves[leaf], work.size()), false, seconds});
    }
  }
  return blocks;
}

class EqualBalancer final : public Balancer {
 public:
  std::vector<PlannedBlock> split(const SplitRequest& request) override {
    const std::vector<double> speeds = usable_speeds(request.speeds);
    const WorkSums area(CostMap().predict(request));
    return planned(SplitTree(speeds.size()).split(area, speeds), speeds.size(), area, false);
  }
  void learn(const MeasuredFrame&) override {}
};

class PbtBalancer final : public Balancer {
 public:
  explicit PbtBalancer(std::size_t leaves_per_node) : leaves_per_node_(leaves_per_node) {}

  std::vector<PlannedBlock> split(const SplitRequest& request) override {
    const std::vector<double> nodes = usable_speeds(request.speeds);
    std::vector<double> speeds;
    for (std::size_t i = 0; i < leaves_per_node_; ++i) speeds.insert(speeds.end(), nodes.begin(), nodes.end());
    if (speeds.size() != leaves_) {
      leaves_ = speeds.size();
      tree_ = SplitTree(leaves_);
    }
    const WorkSums work(cost_.predict(request));
    return planned(tree_.split(work, speeds), nodes.size(), work, cost_.is_known());
  }

  void learn(const MeasuredFrame& frame) override { cost_.learn(frame); }

 private:
  std::size_t leaves_per_node_;
  CostMap cost_{{.times = CellTimes::kUniform, .newest_weight = 1.0, .turns = false, .spreads = 0.0}};
  std::size_t leaves_ = 0;
  SplitTree tree_{0};
};

}  // namespace

std::unique_ptr<Balancer> make_equal_balancer() { return std::make_unique<EqualBalancer>(); }
std::unique_ptr<Balancer> make_pbt_balancer(std::size_t leaves_per_node) {
  return std::make_unique<PbtBalancer>(leaves_per_node);
}

}  // namespace cyclorama::balance
